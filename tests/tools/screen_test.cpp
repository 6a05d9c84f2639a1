// What commands print fits a screen: details give way, the longest first, and what came out stays.
#include "tools/app/cli/screen.h"

#include <gtest/gtest.h>

#include "tests/support/text_lines.h"

namespace leviosim::tools {
namespace {

using Kind = ScreenPiece::Kind;
using tests::lines_of;

std::string rows(const std::string& name, int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += fmt::format("{} {}\n", name, i);
  return text;
}

std::string shown(const std::vector<ScreenPiece>& pieces, int lines, int columns = 80) {
  std::string text;
  for (const ScreenPiece& piece : on_screen(pieces, lines, columns)) text += piece.text;
  return text;
}

TEST(Screen, LongDetailsGiveWayAndWhatCameOutStays) {
  const std::string text =
      shown({{Kind::details, rows("table", 100)}, {Kind::kept, "verdict: met\n"}}, 24);
  const std::vector<std::string> lines = lines_of(text);
  ASSERT_EQ(lines.size(), 24u) << text;
  EXPECT_EQ(lines.front(), "table 0");
  EXPECT_EQ(lines[22], "… 78 more lines: --all shows them");
  EXPECT_EQ(lines.back(), "verdict: met");
}

/// Whatever the pieces: never more lines, none lost that fits, and the numbers add up.
TEST(Screen, HoldsForAnyPieces) {
  for (int a = 0; a <= 40; a += 5)
    for (int b = 0; b <= 40; b += 4)
      for (int kept = 0; kept <= 6; ++kept) {
        const std::vector<ScreenPiece> pieces{{Kind::details, rows("a", a)},
                                              {Kind::details, rows("b", b)},
                                              {Kind::kept, rows("kept", kept)}};
        const std::vector<std::string> lines = lines_of(shown(pieces, 24));
        EXPECT_EQ(lines.size(), static_cast<std::size_t>(std::min(24, a + b + kept)));
        int all = 0;
        for (const std::string& line : lines)
          all += line.starts_with("… ") ? std::stoi(line.substr(std::string("… ").size())) : 1;
        EXPECT_EQ(all, a + b + kept);
      }
}

TEST(Screen, TheLongerDetailsGiveWayFirst) {
  const std::string text =
      shown({{Kind::details, rows("short", 4)}, {Kind::details, rows("long", 90)}}, 24);
  for (const std::string& line : lines_of(rows("short", 4)))
    EXPECT_NE(text.find(line), std::string::npos) << text;
}

TEST(Screen, DocumentsAndCommandsAreWhole) {
  const std::string document = rows("row", 100);
  EXPECT_EQ(shown({{Kind::document, document}}, 24), document);
  EXPECT_EQ(shown({{Kind::details, document}}, 0), document);
  const std::string text = shown({{Kind::commands, "::error\n"},
                                  {Kind::next, "next: a\n"},
                                  {Kind::kept, "kept\n"},
                                  {Kind::next, "next: b\n"}},
                                 24);
  EXPECT_EQ(text, "kept\nnext: b\n::error\n");
}

TEST(Markup, IsEscapedInElementsAndAttributes) {
  EXPECT_EQ(escape_markup("a<b> & \"c\" 'd'"), "a&lt;b&gt; &amp; &quot;c&quot; &#39;d&#39;");
  EXPECT_EQ(escape_markup("10.5° – 🛸\t\n"), "10.5° – 🛸\t\n");
}

TEST(Screen, WideLinesAreBrokenBetweenWords) {
  EXPECT_EQ(shown({{Kind::details, "  aaa bbb ccc ddd\n"}}, 24, 11), "  aaa bbb\n    ccc ddd\n");
  EXPECT_EQ(shown({{Kind::kept, "results: /a/long/path\n"}}, 24, 11), "results: /a/long/path\n");
}

}  // namespace
}  // namespace leviosim::tools
