// Text in aligned columns for terminals.
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace leviosim::tools {

/// Of text that may be as wide as it likes.
inline constexpr int kAnyWidth = std::numeric_limits<int>::max();

/// Columns that tables may take where no width is asked for: any, until the program says what its
/// terminal has. Files and pipes so get all columns.
int table_width();
void set_table_width(int columns);

/// Columns that text takes on a terminal: code points of UTF-8.
int display_width(std::string_view text);

/// Cut to so many columns, with "…" at the end.
std::string shortened(const std::string& text, int width);

class TextTable {
 public:
  enum class Align { Left, Right };
  struct Column {
    std::string title;
    Align align = Align::Right;
    int rank = 0;  ///< where the width is short, the highest rank is left out first
  };

  explicit TextTable(std::vector<Column> columns);

  /// One cell per column.
  void add(std::vector<std::string> cells);
  /// Titles, a rule, and the rows; every line ends in a line break. Columns that do not fit are
  /// left out: those of the highest rank first, of equal ones the last, never the first column; the
  /// titles then end in "…". Before that, columns of long text, which are aligned to the left, are
  /// cut.
  std::string str(int width = table_width()) const;
  /// A table for Markdown files, in which bars and backslashes of cells are escaped.
  std::string markdown() const;

 private:
  /// A line of the columns that have a width.
  std::string line(const std::vector<std::string>& cells, const std::vector<int>& widths) const;
  /// That each column needs.
  std::vector<int> natural_widths() const;
  /// Of each column; 0 for those that are left out.
  std::vector<int> widths_within(int width) const;

  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
};

/// `items` joined by `separator`. Where a line would exceed `width` columns, a line break and
/// `indent` blanks stand in its place; the first line is taken to begin at column `indent`.
std::string wrap(const std::vector<std::string>& items, std::string_view separator, int indent,
                 int width);

inline constexpr auto kLeft = TextTable::Align::Left;
inline constexpr auto kRight = TextTable::Align::Right;

}  // namespace leviosim::tools
