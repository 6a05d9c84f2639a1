// Text in aligned columns for terminals.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace leviosim::tools {

/// Columns that text takes on a terminal: code points of UTF-8.
int display_width(std::string_view text);

class TextTable {
 public:
  enum class Align { Left, Right };
  struct Column {
    std::string title;
    Align align = Align::Right;
  };

  explicit TextTable(std::vector<Column> columns);

  /// One cell per column.
  void add(std::vector<std::string> cells);
  /// Titles, a rule, and the rows; every line ends in a line break.
  std::string str() const;
  /// A table for Markdown files. Cells must hold no bars.
  std::string markdown() const;

 private:
  std::string line(const std::vector<std::string>& cells, const std::vector<int>& widths) const;

  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
};

/// `items` joined by `separator`. Where a line would exceed `width` columns, a line break and
/// `indent` blanks stand in its place; the first line is taken to begin at column `indent`.
std::string wrap(const std::vector<std::string>& items, std::string_view separator, int indent,
                 int width);

inline constexpr auto kLeft = TextTable::Align::Left;
/// What stands in a cell of which nothing is known.
inline constexpr const char* kNothing = "–";

}  // namespace leviosim::tools
