// Parameters of the workload by name, so that a command line or a plan can set them: which there
// are, what they may be, and where each lies in a Profile. Names are paths, "workload.window", as
// those of a chip are ("cluster.workers"). Reading them from text is the tools' business.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "workload/vio/profile.h"

namespace leviosim::vio {

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
};

/// In the order in which a frame meets them.
std::span<const Parameter> parameters();

/// The parameter of that name; nullptr if there is none.
const Parameter* find_parameter(std::string_view name);

/// Whether the parameter can have this value.
bool is_valid(const Parameter& parameter, double value);

/// The value as users write it: "off" and "on" for toggles, else the shortest decimal number that
/// is the same value of the profile (which holds single precision).
std::string value_text(const Parameter& parameter, double value);

/// "6 keyframes", "on": value_text() with the unit.
std::string value_with_unit(const Parameter& parameter, double value);

/// What one parameter is set to.
struct Assignment {
  const Parameter* parameter;
  double value;

  /// "workload.window=6"
  std::string text() const;
};

/// Sets all of them. The values must be valid.
void set_parameters(std::span<const Assignment> assignments, Profile& profile);

}  // namespace leviosim::vio
