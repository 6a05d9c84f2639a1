#include "tools/app/cli/screen.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <optional>
#include <system_error>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/interruption.h"
#include "sim/base/printable.h"
#include "sim/base/text.h"

namespace leviosim::tools {
namespace {

struct Colour {
  std::string_view beginning;  ///< of the lines that have it
  std::string_view code;
  std::string_view also = {};  ///< what else they hold, or lines below that go on with them
};

constexpr std::string_view kPlain = "\x1b[0m";

/// The first that fits is taken.
constexpr std::array kColours{Colour{"verdict: fits: ", "\x1b[33m", "map not judged"},
                              Colour{"verdict: fits: ", "\x1b[32m"},
                              Colour{"verdict: map good", "\x1b[32m"},
                              Colour{"verdict: met: ", "\x1b[32m"},
                              Colour{"verdict: fits on average", "\x1b[33m"},
                              Colour{"verdict: map unreliable", "\x1b[33m"},
                              Colour{"verdict: map not judged", "\x1b[33m"},
                              Colour{"verdict: ", "\x1b[31m"},
                              Colour{"warning: ", "\x1b[33m"}};

std::string_view variable(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? std::string_view() : value;
}

bool stdout_has_colours() {
  return ::isatty(STDOUT_FILENO) == 1 && variable("NO_COLOR").empty() && variable("TERM") != "dumb";
}

/// Of a closed pipe the process dies quietly, as other programs do, once all is put in order.
[[noreturn]] void fail(int error) {
  if (error == EPIPE) throw_if_interrupted();
  throw InputError(
      fmt::format("stdout: cannot be written: {}", std::generic_category().message(error)));
}

void write(const ScreenPiece& piece) {
  const bool is_ours = piece.kind == ScreenPiece::Kind::commands;
  std::string text = is_ours ? piece.text : printable_lines(piece.text);
  if (!is_ours && stdout_has_colours()) text = coloured_lines(text);
  if (std::fwrite(text.data(), 1, text.size(), stdout) < text.size()) fail(errno);
}

/// What the environment says, if it is a whole number.
std::optional<int> number_in(const char* name) {
  const std::string_view text = variable(name);
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (text.empty() || error != std::errc() || number < 0) return std::nullopt;
  return number;
}

/// Columns of the terminal, where stdout is one or the environment says.
std::optional<int> terminal_width() {
  if (const auto columns = number_in("COLUMNS").value_or(0); columns > 0) return columns;
  winsize size{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  if (::isatty(STDOUT_FILENO) == 1) return kScreenColumns;
  return std::nullopt;
}

/// The first line and those below that are indented: what goes on with it.
std::string_view paragraph(std::string_view text) {
  std::size_t end = text.find('\n');
  while (end != std::string_view::npos && text.substr(end + 1).starts_with("  "))
    end = text.find('\n', end + 1);
  return text.substr(0, end);
}

struct Results {
  std::vector<ScreenPiece> pieces;
  bool all = false;

  int lines() const { return all ? 0 : number_in("LINES").value_or(kScreenLines); }
};

Results& results() {
  static Results all;
  return all;
}

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

/// Lines that are too wide, broken between words; what follows is two columns further in.
std::string within(std::string_view text, int columns) {
  constexpr int kFurther = 2;
  constexpr std::size_t kLabelAndPath = 2;  // such a line is left to be copied
  std::string lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = text.substr(begin, end - begin);
    const std::size_t indent = std::min(line.find_first_not_of(' '), line.size());
    const std::vector<std::string> words = base::split(line.substr(indent), ' ');
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

void print_piece(ScreenPiece::Kind kind, std::string text) {
  if (!text.empty()) results().pieces.push_back({kind, std::move(text)});
}

void show_all_results() { results().all = true; }

int output_width() { return terminal_width().value_or(kScreenColumns); }

void fit_tables() {
  set_table_width(terminal_width().value_or(results().lines() == 0 ? kAnyWidth : kScreenColumns));
}

std::string coloured_lines(std::string_view text) {
  std::string coloured;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    const auto colour = std::find_if(kColours.begin(), kColours.end(), [&](const Colour& c) {
      return line.starts_with(c.beginning) &&
             paragraph(text).find(c.also) != std::string_view::npos;
    });
    if (colour == kColours.end())
      coloured += line;
    else
      (((coloured += colour->code) += line) += kPlain);
    if (end < text.size()) coloured += '\n';
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return coloured;
}

void flush_results() {
  const int lines = results().lines();
  for (const ScreenPiece& piece :
       on_screen(std::exchange(results().pieces, {}), lines, output_width()))
    write(piece);
  if (std::fflush(stdout) != 0) fail(errno);
  if (std::ferror(stdout) != 0) fail(EIO);  // of an earlier write
}

void print_error(std::string_view message) {
  std::fputs(fmt::format("leviosim: {}\n", printable(message)).c_str(), stderr);
}

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

std::string wrap_words(std::string_view text, int indent, int width) {
  return wrap(base::split(text, ' '), " ", indent, width);
}

std::string escape_markup(std::string_view text) {
  constexpr std::array<std::pair<char, std::string_view>, 5> kNames{
      {{'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\'', "&#39;"}}};
  std::string escaped;
  for (const char c : text) {
    const auto name =
        std::find_if(kNames.begin(), kNames.end(), [c](const auto& n) { return n.first == c; });
    escaped += name == kNames.end() ? std::string(1, c) : std::string(name->second);
  }
  return escaped;
}

}  // namespace leviosim::tools
