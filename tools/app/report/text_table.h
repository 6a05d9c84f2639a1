// Text in aligned columns for terminals.
#pragma once

#include <concepts>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/base/units.h"
#include "tools/app/cli/terminal.h"

namespace leviosim::tools {

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
  /// A table for Markdown files; cells as markdown_text().
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

inline constexpr auto kLeft = TextTable::Align::Left;
inline constexpr auto kRight = TextTable::Align::Right;

/// What stands in a cell: text, or a whole number.
struct TextCell {
  TextCell(std::string_view words) : text(words) {}
  TextCell(std::string words) : text(std::move(words)) {}
  TextCell(const char* words) : text(words) {}
  template <std::integral T>
  TextCell(T number) : text(std::to_string(number)) {}

  std::string text;
};

/// A table of which each column is described once: its title, and its cell in a row.
template <class Row>
class TableOf {
 public:
  using Of = std::function<TextCell(const Row&)>;
  struct Column {
    TextTable::Column shown;
    Of of;
  };

  TableOf(std::initializer_list<Column> columns) : columns_(columns) {}
  void add(TextTable::Column shown, Of of) {
    columns_.push_back({std::move(shown), std::move(of)});
  }
  template <class Rows>
  TextTable with(const Rows& rows) const {
    std::vector<TextTable::Column> shown;
    for (const Column& column : columns_) shown.push_back(column.shown);
    TextTable table(std::move(shown));
    for (const auto& row : rows) {
      std::vector<std::string> cells;
      for (const Column& column : columns_) cells.push_back(column.of(row).text);
      table.add(std::move(cells));
    }
    return table;
  }

 private:
  std::vector<Column> columns_;
};

// Numbers as text for tables.

/// What stands in a cell of which nothing is known.
inline constexpr const char* kNothing = "–";

/// With so many decimals; `otherwise` for what does not exist.
std::string figure_text(std::optional<double> value, int decimals,
                        std::string_view otherwise = kNothing);

/// In another unit.
inline std::optional<double> scaled(std::optional<double> value, double factor) {
  return value ? std::optional(*value * factor) : std::nullopt;
}

/// A clock in MHz.
inline double megahertz(Hertz clock) { return static_cast<double>(clock.count()) / 1e6; }

/// A text of which no character means something to Markdown or HTML: it makes no tags, links, lists
/// or headings, and mentions nobody.
std::string markdown_text(const std::string& raw);

}  // namespace leviosim::tools
