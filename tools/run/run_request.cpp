#include "tools/run/run_request.h"

namespace leviosim::tools {

vio::Profile profile_of(const RunRequest& request) {
  vio::Profile profile = vio::profile_named(request.profile, request.seed);
  vio::set_parameters(request.workload, profile);
  return profile;
}

}  // namespace leviosim::tools
