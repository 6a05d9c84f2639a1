#include "tools/app/html_report/csv_json.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <vector>

#include "sim/base/error.h"

namespace leviosim::tools {
namespace {

/// Takes the row that begins at `at`, which moves behind its line break.
std::vector<std::string> next_row(const std::string& text, std::size_t& at) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (; at < text.size(); ++at) {
    const char c = text[at];
    if (quoted && c == '"' && at + 1 < text.size() && text[at + 1] == '"') {
      cells.back() += '"';
      ++at;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (!quoted && c == ',') {
      cells.emplace_back();
    } else if (!quoted && c == '\n') {
      ++at;
      break;
    } else if (quoted || c != '\r') {
      cells.back() += c;
    }
  }
  return cells;
}

template <class T>
bool is_number(const std::string& cell, T& value) {
  const char* end = cell.data() + cell.size();
  const auto [stop, error] = std::from_chars(cell.data(), end, value);
  return error == std::errc() && stop == end;
}

Json cell_json(const std::string& cell) {
  if (cell.empty()) return nullptr;
  if (std::int64_t whole = 0; is_number(cell, whole)) return whole;
  if (double number = 0; is_number(cell, number) && std::isfinite(number)) return number;
  return cell;
}

}  // namespace

Json csv_json(const std::string& where, const std::string& text,
              const std::function<bool(const std::string&)>& wanted) {
  std::size_t at = 0;
  const std::vector<std::string> titles = next_row(text, at);
  Json table = Json::object();
  const auto is_wanted = [&](const std::string& title) { return !wanted || wanted(title); };
  for (const std::string& title : titles)
    if (is_wanted(title)) table[title] = Json::array();
  for (std::size_t row = 2; at < text.size(); ++row) {
    const std::vector<std::string> cells = next_row(text, at);
    if (cells.size() != titles.size())
      throw InputError(fmt::format("{}: row {} has {} cells; expected {}, as its titles", where,
                                   row, cells.size(), titles.size()));
    for (std::size_t i = 0; i < titles.size(); ++i)
      if (is_wanted(titles[i])) table[titles[i]].push_back(cell_json(cells[i]));
  }
  return table;
}

}  // namespace leviosim::tools
