#include "tools/app/table/table_files.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>

#include "sim/base/error.h"
#include "sim/base/interruption.h"

namespace leviosim::tools {
namespace {

std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string cell = "\"";
  for (const char c : text) cell += c == '"' ? std::string("\"\"") : std::string(1, c);
  return cell + '"';
}

struct FileText {
  int decimals;

  std::string operator()(std::monostate) const { return {}; }
  std::string operator()(std::int64_t n) const { return std::to_string(n); }
  std::string operator()(double value) const {
    return decimals < 0 ? fmt::format("{}", value) : fmt::format("{:.{}f}", value, decimals);
  }
  std::string operator()(const Banded& b) const { return (*this)(b.value); }
  std::string operator()(const std::string& words) const { return words; }
};

/// The number that CSV shows.
struct JsonValue {
  int decimals;

  Json operator()(std::monostate) const { return nullptr; }
  Json operator()(std::int64_t n) const { return n; }
  Json operator()(double value) const {
    constexpr double kWhole = 0x1p53;
    if (decimals < 0 || !(std::abs(value) < kWhole)) return value;
    // As CSV has it, where the number lies in the middle of two, too.
    const double shown = std::strtod(fmt::format("{:.{}f}", value, decimals).c_str(), nullptr);
    return decimals == 0 ? Json(static_cast<std::int64_t>(shown)) : Json(shown);
  }
  Json operator()(const Banded& b) const { return (*this)(b.value); }
  Json operator()(const std::string& words) const {
    return words.empty() ? Json(nullptr) : Json(words);
  }
};

/// A column as files have it: those with a band become three.
struct FileColumn {
  std::string key;
  std::size_t column;
  int decimals;
  double Banded::*part;

  Cell cell(const std::vector<Cell>& row) const {
    const auto* banded = std::get_if<Banded>(&row[column].value());
    if (banded != nullptr) return banded->*part;
    return part == &Banded::value ? row[column] : Cell();
  }
};

std::vector<FileColumn> file_columns(const Table& table) {
  std::vector<FileColumn> columns;
  for (std::size_t c = 0; c < table.heads().size(); ++c) {
    const Head& head = table.heads()[c];
    if (head.key.empty()) continue;
    columns.push_back({head.key, c, head.decimals, &Banded::value});
    if (!head.is_banded) continue;
    columns.push_back({head.key + "_low", c, head.decimals, &Banded::low});
    columns.push_back({head.key + "_high", c, head.decimals, &Banded::high});
  }
  return columns;
}

/// Takes the row that begins at `at`, which moves behind its line break. By RFC 4180: a quoted cell
/// may hold commas, line breaks, and quotes, which are doubled.
std::vector<std::string> next_row(const std::string& csv, std::size_t& at) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  while (at < csv.size()) {
    const char c = csv[at++];
    if (c == '"' && quoted && at < csv.size() && csv[at] == '"')
      cells.back() += csv[at++];
    else if (c == '"')
      quoted = !quoted;
    else if (quoted || (c != ',' && c != '\n' && c != '\r'))
      cells.back() += c;
    else if (c == ',')
      cells.emplace_back();
    else if (c == '\n')
      break;
  }
  return cells;
}

}  // namespace

std::string csv_line(const std::vector<std::string>& cells) {
  std::string line;
  for (const std::string& cell : cells)
    line += (&cell == &cells.front() ? "" : ",") + csv_cell(cell);
  return line + '\n';
}

std::string csv_text(const Table& table) {
  std::string text;
  write_csv(table, [&](std::string_view line) { text += line; });
  return text;
}

void write_csv(const Table& table, const std::function<void(std::string_view)>& sink) {
  const std::vector<FileColumn> columns = file_columns(table);
  if (columns.empty()) return;
  std::vector<std::string> cells;
  for (const FileColumn& column : columns) cells.push_back(column.key);
  sink(csv_line(cells));
  table.each_row([&](const std::vector<Cell>& row) {
    cells.clear();
    for (const FileColumn& column : columns)
      cells.push_back(std::visit(FileText{column.decimals}, column.cell(row).value()));
    sink(csv_line(cells));
  });
}

Table read_csv(const std::string& where, const std::string& text) {
  std::size_t at = 0;
  std::vector<Head> heads;
  for (std::string& key : next_row(text, at)) heads.push_back({.key = std::move(key)});
  const std::size_t width = heads.size();
  Table table(std::move(heads));
  for (std::size_t row = 2; at < text.size(); ++row) {
    throw_if_interrupted();
    const std::vector<std::string> words = next_row(text, at);
    if (words.size() != width)
      throw InputError(fmt::format("{}: row {} has {} cells; expected {}, as its titles", where,
                                   row, words.size(), width));
    std::vector<Cell> cells;
    for (const std::string& word : words) cells.push_back(spelled(word));
    table.add(std::move(cells));
  }
  return table;
}

Json rows_json(const Table& table) {
  const std::vector<FileColumn> columns = file_columns(table);
  Json rows = Json::array();
  table.each_row([&](const std::vector<Cell>& row) {
    Json& json = rows.emplace_back(Json::object());
    for (const FileColumn& column : columns)
      json[column.key] = std::visit(JsonValue{column.decimals}, column.cell(row).value());
  });
  return rows;
}

Json columns_json(const Table& table, const std::function<bool(const std::string&)>& wanted) {
  Json json = Json::object();
  std::vector<FileColumn> columns = file_columns(table);
  if (wanted) std::erase_if(columns, [&](const FileColumn& c) { return !wanted(c.key); });
  for (const FileColumn& column : columns) json[column.key] = Json::array();
  std::vector<Json*> lists;
  for (const FileColumn& column : columns) lists.push_back(&json[column.key]);
  table.each_row([&](const std::vector<Cell>& row) {
    throw_if_interrupted();
    for (std::size_t c = 0; c < columns.size(); ++c)
      lists[c]->push_back(std::visit(JsonValue{columns[c].decimals}, columns[c].cell(row).value()));
  });
  return json;
}

std::string table_document(const std::string& what, const Table& table, const Json& more) {
  Json document;
  document["format"] = "leviosim " + what;
  document["version"] = 1;
  for (const auto& [name, value] : more.items()) document[name] = value;
  document["rows"] = rows_json(table);
  return json_text(document, 1) + '\n';
}

}  // namespace leviosim::tools
