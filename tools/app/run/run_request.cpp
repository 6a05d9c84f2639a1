#include "tools/app/run/run_request.h"

#include <fmt/format.h>

#include "sim/base/error.h"
#include "workload/vio/profile.h"

namespace leviosim::tools {
namespace {

/// Each workload has parameters of its own.
void check_parameters(const RunRequest& request) {
  for (const vio::Assignment& a : request.workload)
    if (!vio::has_parameter(request.profile, *a.parameter))
      throw InputError(
          fmt::format("{}: '{}' has no such parameter; expected one of its own "
                      "(leviosim workload --profile {})",
                      a.text(), request.profile, request.profile));
}

/// What must hold between parameters of the workload, whatever each may be on its own.
void check_together(const vio::Profile& profile) {
  if (profile.extractor.subpixel_steps > 1 && !profile.optimiser.joint)
    throw InputError(
        "workload.subpixel_steps is above 1 and workload.joint is off: only the joint optimiser's "
        "camera has steps between pixels; expected workload.subpixel_steps=1 or workload.joint=on");
  if (profile.optimiser.joint && !profile.use_imu)
    throw InputError(
        "workload.joint is on, but the profile works without IMU: expected workload.joint=off, or "
        "a profile with IMU");
  if (profile.released && profile.guided.enabled)
    throw InputError(
        "workload.released is on: only levio does as the released program; expected "
        "workload.released=off, or the profile levio");
  if (profile.loop.enabled && !(profile.guided.enabled && profile.optimiser.joint))
    throw InputError(
        "workload.loop is on: it takes landmarks that were tracked and a world whose vertical is "
        "known; expected workload.guided=on and workload.joint=on, as next has them, or "
        "workload.loop=off");
}

}  // namespace

vio::Profile profile_of(const RunRequest& request) {
  check_parameters(request);
  vio::Profile profile = vio::profile_named(request.profile, request.seed);
  vio::set_parameters(request.workload, profile);
  check_together(profile);
  return profile;
}

void check_profile(const RunRequest& request) { profile_of(request); }

}  // namespace leviosim::tools
