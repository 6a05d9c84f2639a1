#include "tools/app/cli/terminal.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <system_error>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/interruption.h"
#include "sim/base/printable_text.h"

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

}  // namespace leviosim::tools
