// All that leviosim prints. stdout has results, stderr one line per error, and progress.
// Results are kept until the command ends, and then shown as a screen of 24 lines,
// or all of them with --all, or as many lines as LINES in the environment says (0: all).
// They are coloured on a terminal only, and not where NO_COLOR is set (no-color.org). Nothing raw
// leaves: control characters and bytes that are no UTF-8 are escaped (sim/base/text.h).
// Newlines and tabs of results stay, so texts from outside are made printable() where they enter a
// result. No line is a command for a server of CI.
//
// A command shows people one screen, so that nothing scrolls away. Details, such as tables, give up
// lines for that, the longest of them first; the conclusion and the next commands stay. Text is
// fitted into lines here, too.
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace leviosim::tools {

inline constexpr int kScreenLines = 24;
inline constexpr int kScreenColumns = 80;

struct ScreenPiece {
  enum class Kind {
    details,   ///< gives way
    kept,      ///< stays
    next,      ///< stays, below these; of several, the last
    document,  ///< is for programs, too: all of it, whatever the screen
    commands,  ///< is for a server of CI: behind all others
  };
  Kind kind;
  std::string text;
};

/// The pieces in the order in which they are shown. Lines of details and of what is kept are broken
/// between words where they are too wide, and so many lines of details left out that all fit:
/// "… N more lines: --all shows them" stands in their place. Details keep their first lines.
/// @param lines  of the screen; 0: any number, and of any width
std::vector<ScreenPiece> on_screen(std::vector<ScreenPiece> pieces, int lines, int columns);

/// Of text that may be as wide as it likes.
inline constexpr int kAnyWidth = std::numeric_limits<int>::max();

/// Columns that tables may take where no width is asked for: any, until the program says what is
/// there.
int table_width();
void set_table_width(int columns);

/// Columns that text takes on a terminal: code points of UTF-8.
int display_width(std::string_view text);

/// Cut to so many columns, with "…" at the end.
std::string shortened(const std::string& text, int width);

/// `items` joined by `separator`. Where a line would exceed `width` columns, a line break and
/// `indent` blanks stand in its place; the first line is taken to begin at column `indent`.
std::string wrap(const std::vector<std::string>& items, std::string_view separator, int indent,
                 int width);

/// The same of a text, which is broken between its words.
std::string wrap_words(std::string_view text, int indent, int width);

/// Text that may stand in an element or an attribute of HTML, XML or SVG. XML has no form for
/// control characters, so text from outside is made printable() first.
std::string escape_markup(std::string_view text);

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
