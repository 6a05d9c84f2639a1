// The names of the workload's functions, as its sources have them.
#pragma once

#include <filesystem>
#include <regex>
#include <set>
#include <string>

#include "sim/base/csv.h"
#include "tests/support/paths.h"

namespace leviosim::tests {

/// The names in `typename P::Function function("name")` and `typename P::Code code("name")`.
inline std::set<std::string> named_functions() {
  static const std::regex scope(
      R"re((?:P::(?:Function|Code)\s+\w+\(|work::CodeName\s+\w+\{)"([^"]+)"[)}])re");
  std::set<std::string> names;
  const std::filesystem::path workload = source_folder() / "workload";
  for (const auto& entry : std::filesystem::recursive_directory_iterator(workload)) {
    if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") continue;
    const std::string text = base::read_text_file(entry.path());
    for (std::sregex_iterator it(text.begin(), text.end(), scope), end; it != end; ++it)
      names.insert((*it)[1]);
  }
  return names;
}

}  // namespace leviosim::tests
