#include "tests/support/paths.h"

#include <cstdlib>

namespace leviosim::tests {

std::filesystem::path source_folder() { return LEVIOSIM_SOURCE_DIR; }

std::filesystem::path rooms_file() { return LEVIOSIM_ROOMS; }

std::filesystem::path build_folder() { return rooms_file().parent_path(); }

std::string program_path() {
  const char* const other = std::getenv("LEVIOSIM_TEST_PROGRAM");
  return other != nullptr ? other : LEVIOSIM_BINARY;
}

}  // namespace leviosim::tests
