#include "tools/app/study/sweep/point_key.h"

#include <fmt/core.h>

#include "sim/base/sha256.h"
#include "tools/app/cli/version.h"

namespace leviosim::tools {

std::string point_key(const std::string& identity) {
  return base::sha256_of(fmt::format("simulator {}\n{}", results_version(), identity));
}

}  // namespace leviosim::tools
