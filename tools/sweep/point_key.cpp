#include "tools/sweep/point_key.h"

#include <fmt/core.h>

#include "sim/base/sha256.h"

namespace leviosim::tools {

std::string point_key(const std::string& identity) {
  return base::sha256_of(fmt::format("simulator {}\n{}", simulator_version(), identity));
}

}  // namespace leviosim::tools
