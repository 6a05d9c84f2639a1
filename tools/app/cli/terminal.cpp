#include "tools/app/cli/terminal.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <system_error>

#include "sim/base/error.h"
#include "sim/base/interruption.h"

namespace leviosim::tools {
namespace {

constexpr int kWidthByDefault = 80;

struct Colour {
  std::string_view beginning;  ///< of the lines that have it
  std::string_view code;
};

constexpr std::string_view kPlain = "\x1b[0m";
/// The first that fits is taken.
constexpr std::array kColours{Colour{"verdict: fits: ", "\x1b[32m"},
                              Colour{"verdict: map good", "\x1b[32m"},
                              Colour{"verdict: fits on average", "\x1b[33m"},
                              Colour{"verdict: map unreliable", "\x1b[33m"},
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

void write(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) < text.size()) fail(errno);
}

}  // namespace

void print_ci_commands(std::string_view lines) { write(lines); }

void print_result_text(std::string_view text) {
  const std::string safe = printable_lines(text);
  write(stdout_has_colours() ? coloured_lines(safe) : safe);
}

std::optional<int> terminal_width() {
  const std::string_view asked = variable("COLUMNS");
  int columns = 0;
  std::from_chars(asked.data(), asked.data() + asked.size(), columns);
  if (columns > 0) return columns;
  winsize size{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  if (::isatty(STDOUT_FILENO) == 1) return kWidthByDefault;
  return std::nullopt;
}

int output_width() { return terminal_width().value_or(kWidthByDefault); }

std::string coloured_lines(std::string_view text) {
  std::string coloured;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    const auto colour = std::find_if(kColours.begin(), kColours.end(), [&](const Colour& c) {
      return line.starts_with(c.beginning);
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
  if (std::fflush(stdout) != 0) fail(errno);
  if (std::ferror(stdout) != 0) fail(EIO);  // of an earlier write
}

void print_error(std::string_view message) {
  std::fputs(fmt::format("leviosim: {}\n", printable(message)).c_str(), stderr);
}

}  // namespace leviosim::tools
