// All that leviosim prints. stdout has results, stderr one line per error; progress is in
// progress_line.h. Results are coloured on a terminal only, and not where NO_COLOR is set
// (no-color.org). Nothing raw leaves: control characters and bytes that are no UTF-8 are escaped
// (sim/base/printable_text.h). Newlines and tabs of results stay, so texts from outside are made
// printable() where they enter a result. No line is a command for a server of CI.
#pragma once

#include <fmt/core.h>

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "sim/base/printable_text.h"

namespace leviosim::tools {

/// To stdout. @throws InputError if it cannot be written, Interrupted if nobody reads it any more
void print_result_text(std::string_view text);

/// Lines that a server of CI obeys, as they are: only leviosim's own, of parts that are printable().
void print_ci_commands(std::string_view lines);

template <class... Args>
void print_result(fmt::format_string<Args...> format, Args&&... args) {
  print_result_text(fmt::format(format, std::forward<Args>(args)...));
}

/// Columns of the terminal that stdout is, 80 where it does not say; nothing for files and pipes.
/// COLUMNS in the environment takes precedence.
std::optional<int> terminal_width();
/// The same for what is made for a screen wherever it goes: 80 for files and pipes, too.
int output_width();

/// Lines that say whether all is well, in colour: "verdict: …" and "warning: …".
std::string coloured_lines(std::string_view text);

/// Hands what was printed to the system, which may refuse it only now: a full disk. Throws as
/// print_result_text() does.
void flush_results();

/// "leviosim: MESSAGE" on one line of stderr, whatever the message holds.
void print_error(std::string_view message);

}  // namespace leviosim::tools
