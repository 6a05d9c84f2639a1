// What a command shows people: one screen, so that nothing of it scrolls away. Details, such as
// tables, give up lines for that, the longest of them first; what came out and what to do next
// stays. And how text is fitted into lines.
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

}  // namespace leviosim::tools
