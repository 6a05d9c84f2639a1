// The tree of a document, and bounds that hold for any text.
#include "sim/base/yaml_document.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

namespace leviosim::base {
namespace {

std::string repeated(const std::string& text, std::size_t times) {
  std::string all;
  for (std::size_t i = 0; i < times; ++i) all += text;
  return all;
}

void expect_fault(const std::string& text, int line, const std::string& path,
                  const std::string& part) {
  SCOPED_TRACE(text.substr(0, 80));
  try {
    parse_yaml(text);
  } catch (const YamlFault& fault) {
    EXPECT_EQ(fault.line(), line) << fault.what();
    EXPECT_EQ(fault.path(), path);
    EXPECT_NE(fault.message().find(part), std::string::npos) << fault.message();
    return;
  }
  ADD_FAILURE() << "no fault";
}

TEST(YamlDocument, GivesTheTreeInTheOrderOfTheFile) {
  const YamlNode root = parse_yaml(
      "# a comment\n"
      "zebra: 1.50   # kept as it is written\n"
      "ape: [a, 'b c', \"d\\n\"]\n"
      "map:\n"
      "  inner: { x: 1, y: }\n"
      "  text: |\n"
      "    two\n"
      "    lines\n");
  ASSERT_TRUE(root.is_mapping());
  const std::vector<YamlEntry> entries = root.entries();
  ASSERT_EQ(entries.size(), 3u);
  EXPECT_EQ(entries[0].key, "zebra");
  EXPECT_EQ(entries[0].line, 2);
  EXPECT_EQ(entries[0].value.scalar(), "1.50");
  const std::vector<YamlNode> items = entries[1].value.items();
  ASSERT_EQ(items.size(), 3u);
  EXPECT_EQ(items[1].scalar(), "b c");
  EXPECT_EQ(items[2].scalar(), "d\n");
  EXPECT_EQ(entries[1].value[0].scalar(), "a");
  const std::vector<YamlEntry> inner = entries[2].value[0].entries();
  EXPECT_EQ(inner[1].key, "y");
  EXPECT_EQ(inner[1].line, 5);
  EXPECT_TRUE(inner[1].value.is_null());
  EXPECT_EQ(entries[2].value[1].scalar(), "two\nlines\n");
}

TEST(YamlDocument, NodesKeepTheTreeAlive) {
  const YamlNode leaf = parse_yaml("a: [b, [c]]")[0][1][0];
  EXPECT_EQ(leaf.scalar(), "c");
}

TEST(YamlDocument, OnlyPlainWordsMeanNothing) {
  for (const char* text : {"a:", "a: ~", "a: null", "a: Null", "a: NULL"})
    EXPECT_TRUE(parse_yaml(text)[0].is_null()) << text;
  for (const char* text : {"a: ''", "a: '~'", "a: \"null\"", "a: !!str null", "a: nULL"})
    EXPECT_TRUE(parse_yaml(text)[0].is_scalar()) << text;
}

TEST(YamlDocument, FaultsOfSyntaxHaveTheirLine) {
  expect_fault(",", 1, "", "not valid YAML");
  expect_fault(",t,x\n0,1,2\n", 1, "", "not valid YAML");
  expect_fault("[1],2", 1, "", "not valid YAML");
  expect_fault("{\"a\":1},\n{\"a\":2}\n", 1, "", "not valid YAML");
  expect_fault("a: 1\nb: [1, 2\nc: 3\n", 3, "",
               "',' or ']' while parsing a flow sequence, column 2");
  expect_fault("a: 1\n\tb: 2\n", 2, "", "not valid YAML");
  expect_fault("a: 1\nb: \xff\n", 2, "", "not valid YAML");
  expect_fault(std::string("a: 1\nb: \0\n", 10), 2, "", "not valid YAML");
  expect_fault("a: \"\x1b[31m\"\n", 1, "", "control characters");
  expect_fault("", 1, "", "empty");
  expect_fault("# nothing\n", 1, "", "empty");
}

TEST(YamlDocument, OneDocument) {
  EXPECT_EQ(parse_yaml("---\na: 1\n...\n").size(), 1u);
  EXPECT_EQ(parse_yaml("\xEF\xBB\xBF"
                       "a: 1\n")
                .entries()[0]
                .key,
            "a");
  expect_fault("a: 1\n---\nb: 2\n", 2, "", "a second document begins; expected one");
}

TEST(YamlDocument, KeysAreWordsAndOccurOnce) {
  expect_fault("a:\n  b: 1\n  c: 2\n  b: 3\n", 4, "a.b", "duplicate key, first given on line 2");
  expect_fault("x: 1\n'x': 2\n", 2, "x", "duplicate key, first given on line 1");
  expect_fault("l:\n- {k: 1}\n- {k: 1, k: 2}\n", 3, "l.k", "duplicate key");
  EXPECT_NO_THROW(parse_yaml("a: {k: 1}\nb: {k: 1}\n"));
  expect_fault("a: {[1]: 2}", 1, "a", "a key is a list; expected a word");
  expect_fault("a: 1\n? {b: 1}\n: 2\n", 2, "", "a key is a map; expected a word");
  expect_fault("a: {~: 2}", 1, "a", "a key is empty; expected a word");
}

TEST(YamlDocument, NoAliases) {
  expect_fault("base: &all { points: *all }\n", 1, "base", "anchors (&) and aliases (*)");
  expect_fault("a: &x 1\nb: *x\n", 1, "a", "anchors");
  expect_fault("a: 1\nb: *x\n", 2, "b", "anchors");
  expect_fault("&x a: 1\n", 1, "", "anchors");
  std::string nested = "a0: &a0 [x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 12; ++i)
    nested += fmt::format("a{0}: &a{0} [*a{1}, *a{1}, *a{1}, *a{1}, *a{1}]\n", i, i - 1);
  expect_fault(nested, 1, "a0", "anchors");
}

TEST(YamlDocument, NoForeignTags) {
  EXPECT_EQ(parse_yaml("a: !!int 5")[0].scalar(), "5");
  EXPECT_TRUE(parse_yaml("!!map {a: !!seq [1]}")[0].is_sequence());
  expect_fault("a: !mine 5", 1, "a", "a tag");
  expect_fault("a: !!map 5", 1, "a", "a tag");
  expect_fault("a: !!python/object 5", 1, "a", "a tag");
}

TEST(YamlDocument, DepthIsBounded) {
  const auto nested = [](std::size_t depth) { return repeated("[", depth) + repeated("]", depth); };
  EXPECT_NO_THROW(parse_yaml(nested(kMostYamlDepth)));
  expect_fault(nested(kMostYamlDepth + 1), 1, "", "deeper than 64 levels");
  expect_fault(repeated("[", 500'000), 1, "", "deeper than 64 levels");
  expect_fault(repeated("{a: ", 200'000), 1, repeated("a.", 63) + "a", "deeper than 64 levels");
  expect_fault(repeated("- ", 500'000), 1, "", "deeper than 64 levels");
  expect_fault(repeated("? ", 500'000), 1, "", "a key is a map");
}

TEST(YamlDocument, TheNumberOfValuesIsBounded) {
  const auto list = [](std::size_t size) { return "[" + repeated("1,", size) + "]"; };
  EXPECT_EQ(parse_yaml(list(kMostYamlNodes - 1)).size(), kMostYamlNodes - 1);
  expect_fault(list(kMostYamlNodes), 1, "", "more than 100000 values");
}

TEST(YamlDocument, TheSizeIsBounded) {
  const std::string most = "a: " + std::string(kMostYamlBytes - 3, 'x');
  EXPECT_EQ(parse_yaml(most)[0].scalar().size(), kMostYamlBytes - 3);
  expect_fault(most + "x", 1, "", "larger than 1048576 bytes");
}

}  // namespace
}  // namespace leviosim::base
