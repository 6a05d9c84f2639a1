#include "tools/app/report/table_document.h"

#include <utility>
#include <vector>

#include "sim/base/check.h"

namespace leviosim::tools {
namespace {

using Cells = std::vector<std::string>;

/// By RFC 4180: a quoted cell may hold commas, line breaks, and quotes, which are doubled.
std::vector<Cells> parse(const std::string& csv) {
  std::vector<Cells> rows;
  Cells row;
  std::string cell;
  bool quoted = false;
  for (std::size_t i = 0; i < csv.size(); ++i) {
    const char c = csv[i];
    if (c == '"' && quoted && i + 1 < csv.size() && csv[i + 1] == '"')
      cell += csv[i++];
    else if (c == '"')
      quoted = !quoted;
    else if (quoted || (c != ',' && c != '\n'))
      cell += c;
    else
      row.push_back(std::exchange(cell, {}));
    if (c == '\n' && !quoted) rows.push_back(std::exchange(row, {}));
  }
  return rows;
}

/// Only what a JSON number would print alike is one: no "nan", no "+1".
Json value_of_cell(const std::string& cell) {
  if (cell.empty()) return nullptr;
  const bool is_number = cell.find_first_not_of("0123456789+-.e") == std::string::npos;
  Json number = is_number ? Json::parse(cell, nullptr, false) : Json(Json::value_t::discarded);
  return number.is_number() ? number : Json(cell);
}

}  // namespace

Json rows_of_csv(const std::string& csv) {
  const std::vector<Cells> lines = parse(csv);
  check(!lines.empty(), "a table has a header");
  Json rows = Json::array();
  for (std::size_t r = 1; r < lines.size(); ++r) {
    check_equal(lines[r].size(), lines[0].size(), "cells in a row of a table");
    Json& row = rows.emplace_back(Json::object());
    for (std::size_t c = 0; c < lines[r].size(); ++c) row[lines[0][c]] = value_of_cell(lines[r][c]);
  }
  return rows;
}

std::string table_document(const std::string& what, const std::string& csv, const Json& more) {
  Json document;
  document["format"] = "leviosim " + what;
  document["version"] = 1;
  for (const auto& [name, value] : more.items()) document[name] = value;
  document["rows"] = rows_of_csv(csv);
  return json_text(document, 1) + '\n';
}

}  // namespace leviosim::tools
