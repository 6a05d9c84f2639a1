#include "tools/app/report/statistic_list.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

#include "sim/base/check.h"
#include "sim/base/error.h"

namespace leviosim::tools {

std::string json_text(const Json& json, int indent) {
  std::string text = json.dump(indent, ' ', false, Json::error_handler_t::replace);
  // Servers of CI obey "##[error]" wherever it stands; it can only stand in a string.
  for (std::size_t at = 0; (at = text.find("##", at)) != std::string::npos;)
    text.replace(at, 2, "#\\u0023");
  return printable_json(text);
}

Json value_of(std::optional<double> value) { return value ? Json(*value) : Json(nullptr); }

Json rounded(double value) { return std::round(value * 1e9) / 1e9; }

void StatisticList::add(const std::string& name, std::string_view unit,
                        std::string_view description, Json value) {
  add_with_protocol(name, unit, description, std::move(value), {});
}

void StatisticList::add_with_protocol(const std::string& name, std::string_view unit,
                                      std::string_view description, Json value,
                                      const std::string& protocol) {
  rows_.push_back({name, std::string(unit), std::string(description), std::move(value), protocol});
}

Json StatisticList::json() const {
  Json list = Json::array();
  for (const StatisticRow& row : rows_) {
    Json& entry = list.emplace_back(Json::object());
    entry["name"] = row.name;
    entry["unit"] = row.unit;
    entry["description"] = row.description;
    entry["value"] = row.value;
    if (!row.protocol.empty()) entry["protocol"] = row.protocol;
  }
  return list;
}

Json statistics_document(Json list, const Json& about) {
  Json document;
  document["format"] = "leviosim statistics";
  document["version"] = kStatisticsVersion;
  document.update(about);
  document["statistics"] = std::move(list);
  return document;
}

std::string statistics_document_text(const Json& document) {
  std::string text;
  for (const auto& [key, value] : document.items())
    if (key != "statistics") text += fmt::format("{}: {}, ", json_text(key), json_text(value));
  std::string lines;
  for (const Json& entry : document.at("statistics"))
    lines += (lines.empty() ? "\n" : ",\n") + json_text(entry);
  return fmt::format("{{{}\"statistics\": [{}\n]}}\n", text, lines);
}

namespace {

using Cells = std::vector<std::string>;

/// Takes the row that begins at `at`, which moves behind its line break. By RFC 4180: a quoted cell
/// may hold commas, line breaks, and quotes, which are doubled.
Cells next_row(const std::string& csv, std::size_t& at) {
  Cells cells(1);
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

/// Only what a JSON number would print alike is one: no "nan", no "+1".
Json value_of_cell(const std::string& cell) {
  if (cell.empty()) return nullptr;
  const bool is_number = cell.find_first_not_of("0123456789+-.e") == std::string::npos;
  Json number = is_number ? Json::parse(cell, nullptr, false) : Json(Json::value_t::discarded);
  return number.is_number() ? number : Json(cell);
}

}  // namespace

Json rows_of_csv(const std::string& csv) {
  check(!csv.empty(), "a table has a header");
  std::size_t at = 0;
  const Cells titles = next_row(csv, at);
  Json rows = Json::array();
  while (at < csv.size()) {
    const Cells cells = next_row(csv, at);
    check_equal(cells.size(), titles.size(), "cells in a row of a table");
    Json& row = rows.emplace_back(Json::object());
    for (std::size_t c = 0; c < cells.size(); ++c) row[titles[c]] = value_of_cell(cells[c]);
  }
  return rows;
}

Json csv_json(const std::string& where, const std::string& text,
              const std::function<bool(const std::string&)>& wanted) {
  std::size_t at = 0;
  const Cells titles = next_row(text, at);
  Json table = Json::object();
  const auto is_wanted = [&](const std::string& title) { return !wanted || wanted(title); };
  for (const std::string& title : titles)
    if (is_wanted(title)) table[title] = Json::array();
  for (std::size_t row = 2; at < text.size(); ++row) {
    const Cells cells = next_row(text, at);
    if (cells.size() != titles.size())
      throw InputError(fmt::format("{}: row {} has {} cells; expected {}, as its titles", where,
                                   row, cells.size(), titles.size()));
    for (std::size_t i = 0; i < titles.size(); ++i)
      if (is_wanted(titles[i])) table[titles[i]].push_back(value_of_cell(cells[i]));
  }
  return table;
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
