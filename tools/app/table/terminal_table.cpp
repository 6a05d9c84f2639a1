#include "tools/app/table/terminal_table.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "sim/base/printable.h"

namespace leviosim::tools {
namespace {

constexpr std::string_view kGap = "  ";
/// Behind the titles, where columns are left out.
constexpr std::string_view kMore = " …";
/// What is left of a column of text that is cut.
constexpr int kLeastText = 20;

std::string spaces(int n) { return std::string(static_cast<std::size_t>(std::max(n, 0)), ' '); }

std::string number_text(const Head& head, double value) {
  if (is_diverged(head, value)) return kDiverged;
  return head.shown < 0 ? fmt::format("{:g}", value * head.scale)
                        : fmt::format("{:.{}f}", value * head.scale, head.shown);
}

struct CellText {
  const Head& head;

  std::string operator()(std::monostate) const { return head.nothing; }
  std::string operator()(std::int64_t n) const {
    return head.scale == 1 ? std::to_string(n) : number_text(head, static_cast<double>(n));
  }
  std::string operator()(double value) const { return number_text(head, value); }
  std::string operator()(const Banded& b) const {
    return fmt::format("{} ({}–{})", number_text(head, b.value), number_text(head, b.low),
                       number_text(head, b.high));
  }
  std::string operator()(const std::string& words) const { return printable(words); }
};

/// The columns that people see, as text.
class TextTable {
 public:
  explicit TextTable(const Table& table) {
    std::vector<std::size_t> shown;
    for (std::size_t c = 0; c < table.heads().size(); ++c) {
      const Head& head = table.heads()[c];
      if (head.title.empty() && !head.key.empty()) continue;
      shown.push_back(c);
      columns_.push_back(&head);
      titles_.push_back(printable(head.title));
    }
    for (const std::vector<Cell>& row : table.rows()) {
      std::vector<std::string>& cells = rows_.emplace_back();
      for (const std::size_t c : shown)
        cells.push_back(std::visit(CellText{table.heads()[c]}, row[c].value()));
    }
  }

  std::string text(int width) const;
  std::string markdown() const;
  std::vector<std::vector<std::string>> cells() const {
    std::vector<std::vector<std::string>> cells{titles_};
    cells.insert(cells.end(), rows_.begin(), rows_.end());
    return cells;
  }

 private:
  /// A line of the columns that have a width.
  std::string line(const std::vector<std::string>& cells, const std::vector<int>& widths) const;
  /// That each column needs.
  std::vector<int> natural_widths() const;
  /// Of each column; 0 for those that are left out.
  std::vector<int> widths_within(int width) const;

  std::vector<const Head*> columns_;
  std::vector<std::string> titles_;
  std::vector<std::vector<std::string>> rows_;
};

std::string TextTable::line(const std::vector<std::string>& cells,
                            const std::vector<int>& widths) const {
  std::string text;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (widths[c] == 0) continue;
    const std::string cell = shortened(cells[c], widths[c]);
    const std::string padding = spaces(widths[c] - display_width(cell));
    if (c > 0) text += kGap;
    text += columns_[c]->align == kLeft ? cell + padding : padding + cell;
  }
  text.erase(text.find_last_not_of(' ') + 1);
  return text + '\n';
}

std::string TextTable::markdown() const {
  const auto row = [](const std::vector<std::string>& cells) {
    std::string text = "|";
    for (const std::string& cell : cells) {
      text += ' ' + markdown_text(cell) + " |";
    }
    return text + '\n';
  };
  std::vector<std::string> rules;
  for (const Head* head : columns_) rules.emplace_back(head->align == kLeft ? "---" : "---:");
  std::string text = row(titles_) + row(rules);
  for (const auto& cells : rows_) text += row(cells);
  return text;
}

std::vector<int> TextTable::natural_widths() const {
  std::vector<int> widths;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    int widest = std::max(1, display_width(titles_[c]));
    for (const auto& row : rows_) widest = std::max(widest, display_width(row[c]));
    widths.push_back(widest);
  }
  return widths;
}

std::vector<int> TextTable::widths_within(int width) const {
  std::vector<int> widths = natural_widths();
  int excess = -display_width(kGap);
  for (const int one : widths) excess += one + display_width(kGap);
  excess -= width;
  const auto cut = [&](std::size_t c, int least) {
    if (columns_[c]->align != kLeft || excess <= 0 || widths[c] <= least) return;
    const int by = std::min(excess, widths[c] - least);
    widths[c] -= by;
    excess -= by;
  };
  cut(0, std::max(kLeastText, width / 2));  // names of rows tell them apart
  bool all = true;
  while (excess > 0) {
    std::size_t last = 0;
    for (std::size_t c = 1; c < columns_.size(); ++c)
      if (widths[c] > 0 && (last == 0 || columns_[c]->rank >= columns_[last]->rank)) last = c;
    if (last == 0) break;
    if (widths[last] - excess >= kLeastText) cut(last, kLeastText);
    if (excess <= 0) break;
    excess -= widths[last] + display_width(kGap);
    widths[last] = 0;
    if (std::exchange(all, false)) excess += display_width(kMore);
  }
  cut(0, 1);
  return widths;
}

std::string TextTable::text(int width) const {
  const std::vector<int> widths = widths_within(width);
  std::string text = line(titles_, widths);
  if (std::find(widths.begin(), widths.end(), 0) != widths.end())
    text.insert(text.size() - 1, kMore);
  int total = -display_width(kGap);
  for (const int one : widths)
    if (one > 0) total += one + display_width(kGap);
  for (int i = 0; i < total; ++i) text += "─";
  text += '\n';
  for (const auto& row : rows_) text += line(row, widths);
  return text;
}

}  // namespace

std::string markdown_text(const std::string& raw) {
  // A word joiner, which nobody sees, parts '@' from the name of a team, and a scheme from its
  // address.
  constexpr const char* kJoiner = "\u2060";
  std::string text;
  const std::string shown = printable(raw);
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const char c = shown[i];
    if (c == '<' || c == '&')
      text += c == '<' ? "&lt;" : "&amp;";
    else if (std::string_view("\\`*_[]#|>~").find(c) != std::string_view::npos)
      text += {'\\', c};
    else if (c == '@')
      text += std::string("@") + kJoiner;
    else if (shown.compare(i, 3, "://") == 0)
      text += std::string(":") + kJoiner;
    else if (c == '.' && i >= 3 && shown.compare(i - 3, 3, "www") == 0)
      text += std::string(".") + kJoiner;
    else
      text += c;
  }
  return text;
}

std::string terminal_text(const Table& table, int width) { return TextTable(table).text(width); }

std::vector<std::vector<std::string>> shown_cells(const Table& table) {
  return TextTable(table).cells();
}

std::string markdown_table(const Table& table) { return TextTable(table).markdown(); }

}  // namespace leviosim::tools
