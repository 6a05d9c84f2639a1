// Files that the project's pages name in backticks exist, so that a rename cannot leave a page
// behind. Left out: the changelog, which tells of files that were, and names with placeholders.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <vector>

#include "tests/support/paths.h"
#include "tests/support/scratch.h"

namespace leviosim::tests {
namespace {

namespace fs = std::filesystem;

/// Files of the project by their paths from its root, each with a slash in front.
std::vector<std::string> files_of_project() {
  std::vector<std::string> files;
  for (fs::recursive_directory_iterator it(source_folder()), end; it != end; ++it) {
    const std::string name = it->path().filename().string();
    if (it.depth() == 0 && (name == "build" || name == "out" || name == ".git"))
      it.disable_recursion_pending();
    else if (it->is_regular_file())
      files.push_back('/' + fs::relative(it->path(), source_folder()).generic_string());
  }
  return files;
}

/// Names of sources and scripts in backticks.
std::vector<std::string> names_in(const std::string& line) {
  static const std::regex name(R"(`([A-Za-z0-9_./-]+\.(h|cpp|sh|py|cmake))`)");
  std::vector<std::string> names;
  for (std::sregex_iterator it(line.begin(), line.end(), name), end; it != end; ++it)
    names.push_back((*it)[1]);
  return names;
}

/// Whether a file has this path, or one that ends in it.
bool exists(const std::string& name, const std::vector<std::string>& files) {
  return std::any_of(files.begin(), files.end(),
                     [&](const std::string& file) { return file.ends_with('/' + name); });
}

TEST(PageFiles, NamedInPagesExist) {
  const std::vector<std::string> files = files_of_project();
  int count = 0;
  std::string faults;
  for (const std::string& file : files) {
    // The facts name files of the chips' vendors, too.
    if (!file.ends_with(".md") || file == "/CHANGELOG.md" || file.ends_with("/FACTS.md")) continue;
    std::ifstream in(source_folder() / file.substr(1));
    std::string line;
    for (int number = 1; std::getline(in, line); ++number)
      for (const std::string& name : names_in(line)) {
        ++count;
        if (name.find("NAME") == std::string::npos && !exists(name, files))
          faults += file + ':' + std::to_string(number) + ": no file " + name + '\n';
      }
  }
  EXPECT_GT(count, 300);
  EXPECT_EQ(faults, "");
}

/// tests/mutants.txt: what a mutant replaces is in its file, and there once.
TEST(PageFiles, MutantsChangeTheCodeOfNow) {
  std::ifstream list(source_folder() / "tests/mutants.txt");
  std::string file, faults;
  int count = 0;
  for (std::string line; std::getline(list, line);) {
    if (line.starts_with("@ ")) file = line.substr(2);
    if (!line.starts_with("- ")) continue;
    ++count;
    const std::string text = read_text(source_folder() / file), old = line.substr(2);
    const std::size_t at = text.find(old);
    if (at == std::string::npos || text.find(old, at + 1) != std::string::npos)
      faults += file + ": expected once: " + old + '\n';
  }
  EXPECT_GT(count, 150);
  EXPECT_EQ(faults, "");
}

TEST(PageFiles, NamesAreFound) {
  const std::vector<std::string> files{"/sim/chip/cost.h"};
  EXPECT_EQ(names_in("see `sim/chip/cost.h`, `cost.h` and cost.h, not `cost`"),
            (std::vector<std::string>{"sim/chip/cost.h", "cost.h"}));
  EXPECT_TRUE(exists("chip/cost.h", files));
  EXPECT_FALSE(exists("ost.h", files));
  EXPECT_FALSE(exists("sim/cost.h", files));
}

}  // namespace
}  // namespace leviosim::tests
