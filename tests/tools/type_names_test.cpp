// No two headers define a type of the same name in the same namespace: the linker would take one
// definition for both, and what goes wrong then shows anywhere.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <string>

#include "tests/support/paths.h"

namespace leviosim::tests {
namespace {

namespace fs = std::filesystem;

/// Types at the top of a namespace, "leviosim::tools::Budget", but for specialisations. A header
/// has one namespace.
std::vector<std::string> types_of(std::istream& header) {
  static const std::regex space(R"re(^namespace (\S+) \{)re");
  static const std::regex type(R"re(^(?:struct|class|enum class) (\w+)(?![\w<])[^;]*\{)re");
  std::vector<std::string> types;
  std::string name;
  for (std::string line; std::getline(header, line);) {
    std::smatch found;
    if (std::regex_search(line, found, space)) name = found[1];
    if (std::regex_search(line, found, type)) types.push_back(name + "::" + found[1].str());
  }
  return types;
}

TEST(TypeNames, AreReadFromHeaders) {
  std::istringstream header(
      "namespace a::b {\nstruct One {\n  struct Inner {};\n};\nclass Two;\nclass Three : public "
      "One "
      "{};\nenum class Four : int { x };\n");
  EXPECT_EQ(types_of(header), (std::vector<std::string>{"a::b::One", "a::b::Three", "a::b::Four"}));
}

TEST(TypeNames, AreDefinedOnce) {
  std::map<std::string, std::string> header_of;
  for (const char* part : {"sim", "workload", "platform_models", "traces", "tools"})
    for (const auto& entry : fs::recursive_directory_iterator(source_folder() / part)) {
      const std::string file = fs::relative(entry.path(), source_folder()).string();
      if (entry.path().extension() != ".h" || file.rfind("tools/rv32", 0) == 0) continue;
      std::ifstream header(entry.path());
      for (const std::string& type : types_of(header)) {
        const auto [other, is_new] = header_of.emplace(type, file);
        EXPECT_TRUE(is_new) << type << " is in " << other->second << " and in " << file;
      }
    }
  EXPECT_GT(header_of.size(), 100u);
}

}  // namespace
}  // namespace leviosim::tests
