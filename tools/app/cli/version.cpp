#include "tools/app/cli/version.h"

namespace leviosim::tools {

std::string_view version() { return LEVIOSIM_VERSION; }
std::string_view revision() { return LEVIOSIM_REVISION; }

}  // namespace leviosim::tools
