#include "tools/cli/version.h"

namespace leviosim::tools {

std::string_view version() { return LEVIOSIM_VERSION; }
std::string_view revision() { return LEVIOSIM_REVISION; }
std::string_view flight_version() { return LEVIOSIM_FLIGHT_VERSION; }

}  // namespace leviosim::tools
