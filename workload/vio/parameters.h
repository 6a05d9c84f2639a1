// Parameters of the workload by name, so that a command line or a plan can set them: which there
// are, what they may be, and where each lies in a Profile. Names are paths, "workload.window", as
// those of a chip are ("cluster.workers"). Reading them from text is the tools' business.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace leviosim::vio {

struct Profile;

/// Of all names below.
inline constexpr std::string_view kParameterPrefix = "workload.";

struct Parameter {
  enum class Kind { number, whole, toggle };  ///< a toggle is 0 (off) or 1 (on)

  std::string_view name;
  Kind kind;
  std::string_view unit;
  double low, high;  ///< valid values, both included
  std::string_view description;
  bool needs_imu;  ///< has no effect on profiles without IMU
  double (*get)(const Profile&);
  void (*set)(Profile&, double);
  double initial = 0;  ///< of a parameter of another workload: what it is where nothing sets it

  /// Of another workload than the odometry, whose profiles do not have it.
  bool is_of_another() const { return get == nullptr; }
};

/// A parameter of another workload. The texts are literals; `name` begins with "workload.".
constexpr Parameter other_parameter(std::string_view name, Parameter::Kind kind,
                                    std::string_view unit, double low, double high, double initial,
                                    std::string_view description) {
  return {name, kind, unit, low, high, description, false, nullptr, nullptr, initial};
}

/// Another workload than the odometry, which users name as they name a profile.
struct OtherProfile {
  std::string name;
  std::string description;          ///< a few words
  std::vector<std::string> stages;  ///< in the order of a frame
  std::vector<Parameter> parameters;
};

/// From now on profile_named(), profile_names() and parameters() know it; before anything asks for
/// them, and by one thread. @throws InputError for a name that there is already
void add_profile(OtherProfile profile);

std::span<const OtherProfile> other_profiles();
/// nullptr for profiles of the odometry, and for names that nobody knows.
const OtherProfile* other_profile(std::string_view name);

std::vector<std::string> profile_names();
/// What distinguishes it, in a few words. The name must be known.
std::string_view profile_description(std::string_view name);
/// @throws InputError for an unknown name, with those that are known
void expect_profile(std::string_view name);
/// Whether the optimiser has inertial terms. The name must be known.
bool uses_imu(std::string_view profile);

/// Whether the parameter is one of the workload that the profile is of.
bool has_parameter(std::string_view profile, const Parameter& parameter);

/// What runs where no profile is named: the other workload, if there is one, or levio.
std::string_view default_profile();

/// In the order in which a frame meets them; those of other workloads last.
std::span<const Parameter> parameters();

/// The parameter of that name; nullptr if there is none.
const Parameter* find_parameter(std::string_view name);

/// Whether the parameter can have this value.
bool is_valid(const Parameter& parameter, double value);

/// The value as users write it: "off" and "on" for toggles, else the shortest decimal number that
/// is the same value of the profile (which holds single precision).
std::string value_text(const Parameter& parameter, double value);

/// What one parameter is set to.
struct Assignment {
  const Parameter* parameter;
  double value;

  /// "workload.window=6"
  std::string text() const;
};

/// Sets all of them but those of other workloads. The values must be valid.
void set_parameters(std::span<const Assignment> assignments, Profile& profile);

}  // namespace leviosim::vio
