#include "tools/app/report/statistic_list.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

namespace leviosim::tools {

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

}  // namespace leviosim::tools
