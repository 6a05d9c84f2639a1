// Text for terminals: what is escaped, what stays, and that nothing else comes out of any bytes.
#include "sim/base/printable.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <string>

namespace leviosim {
namespace {

struct Case {
  std::string text;
  std::string printed;
};

TEST(PrintableText, EscapesWhatATerminalWouldObeyAndNothingElse) {
  using namespace std::string_literals;
  for (const Case& c : std::vector<Case>{
           {"", ""},
           {"plain text, 'quoted' & <marked>", "plain text, 'quoted' & <marked>"},
           {"back\\slash \\x1b", "back\\slash \\x1b"},
           {"a\nb\tc\rd", "a\\nb\\tc\\rd"},
           {"\x1b[2J\x07", "\\x1b[2J\\x07"},
           {"nul\0end"s, "nul\\x00end"},
           {"del\x7f", "del\\x7f"},
           {"µm · – × … 中 🚁", "µm · – × … 中 🚁"},
           {"C1: \xc2\x9b", "C1: \\xc2\\x9b"},
           {"NEL \xc2\x85, NBSP \xc2\xa0", "NEL \\xc2\\x85, NBSP \xc2\xa0"},
           {"\xe2\x80\xa8\xe2\x80\xa9", "\\xe2\\x80\\xa8\\xe2\\x80\\xa9"},    // U+2028, U+2029
           {"\xe2\x80\xaetxt.exe", "\\xe2\\x80\\xaetxt.exe"},                 // U+202E
           {"\xe2\x81\xa6x\xe2\x81\xa9", "\\xe2\\x81\\xa6x\\xe2\\x81\\xa9"},  // U+2066, U+2069
           {"\xe2\x80\xa7\xe2\x80\xaf\xe2\x81\xa5\xe2\x81\xaa",               // their neighbours
            "\xe2\x80\xa7\xe2\x80\xaf\xe2\x81\xa5\xe2\x81\xaa"},
           {"\xef\xbf\xbd\xef\xbf\xbe\xef\xbf\xbf", "\xef\xbf\xbd\\xef\\xbf\\xbe\\xef\\xbf\\xbf"},
           {"\xff\xfe", "\\xff\\xfe"},
           {"cut \xe2\x82", "cut \\xe2\\x82"},
           {"lone \x80.", "lone \\x80."},
           {"overlong \xc0\xaf \xe0\x80\xaf", "overlong \\xc0\\xaf \\xe0\\x80\\xaf"},
           {"surrogate \xed\xa0\x80", "surrogate \\xed\\xa0\\x80"},
           {"too large \xf4\x90\x80\x80", "too large \\xf4\\x90\\x80\\x80"},
           {"largest \xf4\x8f\xbf\xbd", "largest \xf4\x8f\xbf\xbd"},
           {"five \xf8\x88\x80\x80\x80", "five \\xf8\\x88\\x80\\x80\\x80"}})
    EXPECT_EQ(printable(c.text), c.printed);
}

TEST(PrintableText, LinesKeepNewlinesAndTabs) {
  EXPECT_EQ(printable_lines("a\tb\n\x1b[0m\r\n"), "a\tb\n\\x1b[0m\\r\n");
  EXPECT_EQ(printable_lines(std::string("\0", 1)), "\\x00");
}

TEST(PrintableText, NoLineIsACommandOfAServer) {
  for (const Case& c : std::vector<Case>{{"::error::x", ": :error::x"},
                                         {" \t::stop-commands::x", " \t: :stop-commands::x"},
                                         {"a\n::x", "a\n: :x"},
                                         {"\xc2\xa0::x", "\xc2\xa0: :x"},
                                         {":::", ": ::"},
                                         {"std::string, a ::b", "std::string, a ::b"},
                                         {"a ##[error]b", "a ## [error]b"},
                                         {"###[x]", "### [x]"},
                                         {"##vso[task.complete]", "## vso[task.complete]"},
                                         {"### 2 stages", "### 2 stages"}})
    EXPECT_EQ(printable_lines(c.text), c.printed);
  EXPECT_EQ(printable("a\n::x"), "a\\n::x");
}

/// Decoded here anew, by the table of well-formed byte sequences of the Unicode standard (3-7).
bool is_plain(const std::string& text) {
  const auto in = [&](std::size_t i, int low, int high) {
    const int byte = i < text.size() ? static_cast<unsigned char>(text[i]) : -1;
    return byte >= low && byte <= high;
  };
  for (std::size_t i = 0; i < text.size();) {
    if (in(i, 0x20, 0x7e)) {
      i += 1;
    } else if (in(i, 0xc2, 0xdf) && in(i + 1, 0x80, 0xbf)) {
      if (in(i, 0xc2, 0xc2) && in(i + 1, 0x80, 0x9f)) return false;
      i += 2;
    } else if (in(i + 2, 0x80, 0xbf) && ((in(i, 0xe0, 0xe0) && in(i + 1, 0xa0, 0xbf)) ||
                                         (in(i, 0xe1, 0xec) && in(i + 1, 0x80, 0xbf)) ||
                                         (in(i, 0xed, 0xed) && in(i + 1, 0x80, 0x9f)) ||
                                         (in(i, 0xee, 0xef) && in(i + 1, 0x80, 0xbf)))) {
      i += 3;
    } else if (in(i + 2, 0x80, 0xbf) && in(i + 3, 0x80, 0xbf) &&
               ((in(i, 0xf0, 0xf0) && in(i + 1, 0x90, 0xbf)) ||
                (in(i, 0xf1, 0xf3) && in(i + 1, 0x80, 0xbf)) ||
                (in(i, 0xf4, 0xf4) && in(i + 1, 0x80, 0x8f)))) {
      i += 4;
    } else {
      return false;
    }
  }
  return true;
}

TEST(PrintableText, GivesPlainTextForAnyBytesAndChangesItNoMore) {
  std::mt19937 random(7);
  // Bytes that matter are frequent: leads, continuations, edges of ranges.
  const std::string edges =
      "\xe2\x80\xa8\xae\x81\xa6\xc2\x85\x9b\xed\xa0\xf4\x8f\x90\xf0\xef\xbf\xbe\n";
  for (int trial = 0; trial < 200'000; ++trial) {
    std::string text(random() % 12, ' ');
    for (char& c : text)
      c = random() % 2 == 0 ? edges[random() % edges.size()] : static_cast<char>(random());
    const std::string once = printable(text);
    ASSERT_TRUE(is_plain(once)) << once;
    ASSERT_EQ(printable(once), once);
    if (is_plain(text) && text.find('\xe2') == std::string::npos &&
        text.find('\xef') == std::string::npos) {
      ASSERT_EQ(once, text);
    }
  }
}

TEST(PrintableText, OneWordOfAShellStaysOne) {
  for (const auto& [word, typed] :
       {std::pair{"a/b-1.yaml", "a/b-1.yaml"}, std::pair{"a b", "'a b'"}, std::pair{"", "''"},
        std::pair{"it's", "'it'\\''s'"}, std::pair{"~", "'~'"}, std::pair{"a\nb", "'a\\nb'"}})
    EXPECT_EQ(shell_word(word), typed);
}

}  // namespace
}  // namespace leviosim
