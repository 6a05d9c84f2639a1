// All that leviosim prints. stdout has results, stderr one line per error; progress is in
// progress_line.h. Results are kept until the command ends, and then shown as a screen of 24 lines
// (screen.h), or all of them with --all, or as many lines as LINES in the environment says (0: all).
// They are coloured on a terminal only, and not where NO_COLOR is set (no-color.org). Nothing raw
// leaves: control characters and bytes that are no UTF-8 are escaped (sim/base/printable_text.h).
// Newlines and tabs of results stay, so texts from outside are made printable() where they enter a
// result. No line is a command for a server of CI.
#pragma once

#include <string>
#include <string_view>

#include "tools/app/cli/screen.h"

namespace leviosim::tools {

/// For stdout, once the command ends.
void print_piece(ScreenPiece::Kind kind, std::string text);

/// All that was kept, to stdout and on to the system, which may refuse it only now: a full disk.
/// @throws InputError if it cannot be written, Interrupted if nobody reads it any more
void flush_results();

/// Shows all of the results, whatever the screen, and in files and pipes tables of any width.
void show_all_results();

/// Columns of the terminal that stdout is, else 80; COLUMNS in the environment takes precedence.
int output_width();
/// Tells tables what they may take: the same, or any.
void fit_tables();

/// Lines that say whether all is well, in colour: "verdict: …" and "warning: …".
std::string coloured_lines(std::string_view text);

/// "leviosim: MESSAGE" on one line of stderr, whatever the message holds.
void print_error(std::string_view message);

}  // namespace leviosim::tools
