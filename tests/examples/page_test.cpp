// The page workload/EXTENDING.md shows code that is compiled: its code blocks are the text between
// the marks of the files that it names.
#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "sim/base/csv.h"
#include "tests/support/paths.h"

namespace leviosim::example {
namespace {

const std::filesystem::path kSource = leviosim::tests::source_folder();

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// A fenced block, and what the comment on the line before says it is: "FILE, MARK".
struct CodeBlock {
  std::string language;
  std::optional<std::string> file, mark;
  std::string text;
};

std::vector<CodeBlock> blocks_of(const std::vector<std::string>& page) {
  std::vector<CodeBlock> blocks;
  for (std::size_t i = 0; i < page.size(); ++i) {
    if (page[i].rfind("```", 0) != 0) continue;
    CodeBlock block;
    block.language = page[i].substr(3);
    const std::string before = i > 0 ? page[i - 1] : "";
    const auto comma = before.find(", ");
    if (before.rfind("<!-- ", 0) == 0 && comma != std::string::npos) {
      block.file = before.substr(5, comma - 5);
      block.mark = before.substr(comma + 2, before.find(" -->") - comma - 2);
    }
    for (++i; i < page.size() && page[i] != "```"; ++i) block.text += page[i] + '\n';
    blocks.push_back(block);
  }
  return blocks;
}

/// The lines between "// [mark]" and "// [/mark]", or after "#".
std::string excerpt(const std::string& file, const std::string& mark) {
  std::string text;
  bool inside = false;
  int marks = 0;
  for (const std::string& line : lines_of(base::read_text_file(kSource / file))) {
    const bool end = line == "// [/" + mark + "]" || line == "# [/" + mark + "]";
    if (end) inside = false;
    if (inside) text += line + '\n';
    if (line == "// [" + mark + "]" || line == "# [" + mark + "]") inside = true, ++marks;
  }
  EXPECT_EQ(marks, 1) << file << " has the mark [" << mark << "] so many times";
  EXPECT_FALSE(inside) << file << ": [" << mark << "] has no end";
  return text;
}

std::vector<CodeBlock> page() {
  return blocks_of(lines_of(base::read_text_file(kSource / "workload/EXTENDING.md")));
}

TEST(ExtendingPage, ShowsTheFilesThatAreCompiled) {
  int shown = 0;
  for (const CodeBlock& block : page()) {
    if (block.language == "sh") continue;
    ASSERT_TRUE(block.file) << "a block of " << block.language << " names no file:\n" << block.text;
    EXPECT_EQ(block.text, excerpt(*block.file, *block.mark)) << *block.file << ", " << *block.mark;
    ++shown;
  }
  EXPECT_EQ(shown, 7);
}

TEST(ExtendingPage, NamesFilesThatAreThere) {
  std::string text;
  bool code = false;
  for (const std::string& line : lines_of(base::read_text_file(kSource / "workload/EXTENDING.md")))
    if (line.rfind("```", 0) == 0)
      code = !code;
    else if (!code)
      text += line + '\n';
  int links = 0;
  for (std::size_t at = text.find("]("); at != std::string::npos; at = text.find("](", at + 1)) {
    const std::string link = text.substr(at + 2, text.find(')', at) - at - 2);
    EXPECT_TRUE(std::filesystem::exists(kSource / "workload" / link)) << link;
    ++links;
  }
  EXPECT_GT(links, 5);
}

}  // namespace
}  // namespace leviosim::example
