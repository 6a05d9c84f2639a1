#include "tools/app/cli/screen.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace leviosim::tools {
namespace {

using Kind = ScreenPiece::Kind;

/// What is left of details while there is room: their heading, a line, and how many more there are.
constexpr int kFewest = 3;

int default_width = kAnyWidth;

int lines_of(std::string_view text) {
  return static_cast<int>(std::count(text.begin(), text.end(), '\n'));
}

void keep_lines(std::string& text, int lines) {
  const int left_out = lines_of(text) - (lines - 1);
  std::size_t end = 0;
  for (int line = 0; line < lines - 1; ++line) end = text.find('\n', end) + 1;
  text.resize(end);
  text += fmt::format("… {} more lines: --all shows them\n", left_out);
}

std::string blanks(int n) { return std::string(static_cast<std::size_t>(std::max(n, 0)), ' '); }

std::vector<std::string> words_of(std::string_view line) {
  std::vector<std::string> words;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(' ', begin), line.size());
    words.emplace_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return words;
}

/// Lines that are too wide, broken between words; what follows is two columns further in.
std::string within(std::string_view text, int columns) {
  constexpr int kFurther = 2;
  constexpr std::size_t kLabelAndPath = 2;  // such a line is left to be copied
  std::string lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = text.substr(begin, end - begin);
    const std::size_t indent = std::min(line.find_first_not_of(' '), line.size());
    const std::vector<std::string> words = words_of(line.substr(indent));
    if (display_width(line) <= columns || words.size() <= kLabelAndPath)
      lines += line;
    else
      lines += blanks(static_cast<int>(indent)) +
               wrap(words, " ", static_cast<int>(indent) + kFurther, columns);
    lines += '\n';
    begin = end + 1;
  }
  return lines;
}

/// Commands of CI last, and before them what to do next.
std::vector<ScreenPiece> in_order(std::vector<ScreenPiece> pieces) {
  const auto is = [](Kind kind) {
    return [kind](const ScreenPiece& piece) { return piece.kind == kind; };
  };
  const auto last_next = std::find_if(pieces.rbegin(), pieces.rend(), is(Kind::next));
  std::vector<ScreenPiece> ordered;
  for (const ScreenPiece& piece : pieces)
    if (piece.kind != Kind::next && piece.kind != Kind::commands) ordered.push_back(piece);
  if (last_next != pieces.rend()) ordered.push_back(*last_next);
  std::copy_if(pieces.begin(), pieces.end(), std::back_inserter(ordered), is(Kind::commands));
  return ordered;
}

}  // namespace

std::vector<ScreenPiece> on_screen(std::vector<ScreenPiece> pieces, int lines, int columns) {
  pieces = in_order(std::move(pieces));
  if (lines == 0) return pieces;
  for (ScreenPiece& piece : pieces)
    if (piece.kind == Kind::details || piece.kind == Kind::kept)
      piece.text = within(piece.text, columns);
  std::vector<int> shown;
  int excess = -lines;
  for (const ScreenPiece& piece : pieces) {
    const bool takes_room = piece.kind != Kind::document && piece.kind != Kind::commands;
    shown.push_back(takes_room ? lines_of(piece.text) : 0);
    excess += shown.back();
  }
  for (const int fewest : {kFewest, 1})
    for (; excess > 0; --excess) {
      std::size_t longest = pieces.size();
      for (std::size_t i = 0; i < pieces.size(); ++i)
        if (pieces[i].kind == Kind::details && shown[i] > fewest &&
            (longest == pieces.size() || shown[i] >= shown[longest]))
          longest = i;
      if (longest == pieces.size()) break;
      --shown[longest];
    }
  for (std::size_t i = 0; i < pieces.size(); ++i)
    if (pieces[i].kind == Kind::details && shown[i] < lines_of(pieces[i].text))
      keep_lines(pieces[i].text, shown[i]);
  return pieces;
}

int table_width() { return default_width; }

void set_table_width(int columns) { default_width = columns; }

int display_width(std::string_view text) {
  const auto continues = [](char c) { return (static_cast<unsigned char>(c) & 0xC0u) == 0x80u; };
  return static_cast<int>(text.size()) -
         static_cast<int>(std::count_if(text.begin(), text.end(), continues));
}

std::string shortened(const std::string& text, int width) {
  if (display_width(text) <= width) return text;
  std::string shorter;
  for (const char c : text) {
    const bool begins = (static_cast<unsigned char>(c) & 0xC0u) != 0x80u;
    if (begins && display_width(shorter) >= width - 1) break;
    shorter += c;
  }
  return shorter + "…";
}

std::string wrap(const std::vector<std::string>& items, std::string_view separator, int indent,
                 int width) {
  std::string text;
  int used = indent;
  for (const std::string& item : items) {
    const bool first = text.empty();
    const int needed = display_width(item) + (first ? 0 : display_width(separator));
    if (!first && used + needed > width) {
      text += '\n' + blanks(indent);
      used = indent + display_width(item);
    } else {
      if (!first) text += separator;
      used += needed;
    }
    text += item;
  }
  return text;
}

}  // namespace leviosim::tools
