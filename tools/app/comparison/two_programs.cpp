#include "tools/app/comparison/two_programs.h"

#include <fmt/format.h>

#include <cstdlib>

#include "sim/base/error.h"
#include "tools/app/cli/child.h"

namespace leviosim::tools {
namespace {

std::filesystem::path new_folder() {
  std::string name = (std::filesystem::temp_directory_path() / "leviosim-programs-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr)
    throw InputError(fmt::format("{}: cannot be made", name));
  return name;
}

}  // namespace

TwoPrograms::TwoPrograms(const std::vector<std::string>& programs,
                         const std::vector<std::string>& arguments) {
  if (programs.size() != 2)
    throw InputError(
        fmt::format("--programs: expected two programs, found {}", programs.size()));
  place_ = new_folder();
  try {
    for (const std::string& program : programs) {
      folders_.push_back((place_ / (folders_.empty() ? "A" : "B")).string());
      std::vector<std::string> words{program, "run"};
      words.insert(words.end(), arguments.begin(), arguments.end());
      words.insert(words.end(), {"--quiet", "--out", folders_.back()});
      if (const int status = run_child(words); status != 0)
        throw InputError(fmt::format("{}: run ended with status {}", program, status));
    }
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove_all(place_, ignored);
    throw;
  }
}

TwoPrograms::~TwoPrograms() {
  std::error_code ignored;
  std::filesystem::remove_all(place_, ignored);
}

}  // namespace leviosim::tools
