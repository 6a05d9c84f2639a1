#include "tools/app/cli/version.h"

#include "sim/base/sha256.h"

namespace leviosim::tools {

std::string_view version() { return LEVIOSIM_VERSION; }
std::string_view revision() { return LEVIOSIM_REVISION; }

namespace {

std::string& results_of_program() {
  static std::string digest(results_sources());
  return digest;
}

}  // namespace

std::string_view results_version() { return results_of_program(); }

void include_own_code(const std::string& digest) {
  results_of_program() = base::sha256_of(results_of_program() + digest);
}

}  // namespace leviosim::tools
