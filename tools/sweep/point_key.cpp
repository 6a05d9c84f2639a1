#include "tools/sweep/point_key.h"

#include <fmt/core.h>

#include "tools/run/digest.h"

namespace leviosim::tools {

std::string point_key(const std::string& identity) {
  Sha256 digest;
  digest.add(fmt::format("simulator {}\n{}", simulator_version(), identity));
  return digest.hex();
}

}  // namespace leviosim::tools
