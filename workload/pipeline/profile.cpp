#include "workload/pipeline/profile.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "sim/error.h"

namespace leviosim::vio {
namespace {

struct NamedProfile {
  std::string_view name;
  std::string_view description;
  void (*adjust)(Profile&);  ///< starts from the defaults, which are `levio`
};

constexpr std::array kProfiles = {
    NamedProfile{"levio", "as the paper has it", [](Profile&) {}},
    NamedProfile{"levio-no-imu", "without inertial terms in the optimiser",
                 [](Profile& p) { p.use_imu = p.optimiser.use_imu = false; }},
    NamedProfile{"levio-no-imu-no-epnp", "8-point poses only, without inertial terms",
                 [](Profile& p) { p.use_imu = p.optimiser.use_imu = p.use_epnp = false; }},
};

}  // namespace

Profile profile_named(std::string_view name, std::uint32_t seed) {
  const auto it = std::find_if(kProfiles.begin(), kProfiles.end(),
                               [&](const NamedProfile& p) { return p.name == name; });
  if (it == kProfiles.end())
    throw InputError(fmt::format("unknown profile '{}'; known profiles are {}", name,
                                 fmt::join(profile_names(), ", ")));
  Profile profile;
  profile.name = name;
  // Different streams for the two estimators; an odd factor keeps different seeds apart.
  profile.pnp.seed = seed * 0x9e3779b1u + 1;
  profile.essential.seed = seed * 0x85ebca6bu + 2;
  it->adjust(profile);
  return profile;
}

std::vector<std::string> profile_names() {
  std::vector<std::string> names;
  for (const NamedProfile& p : kProfiles) names.emplace_back(p.name);
  return names;
}

}  // namespace leviosim::vio
