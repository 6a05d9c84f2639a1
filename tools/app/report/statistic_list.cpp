#include "tools/app/report/statistic_list.h"

#include <fmt/core.h>

#include <cmath>
#include <utility>

namespace leviosim::tools {

std::string json_text(const Json& json, int indent) {
  std::string text = json.dump(indent, ' ', false, Json::error_handler_t::replace);
  // Servers of CI obey "##[error]" wherever it stands; it can only stand in a string.
  for (std::size_t at = 0; (at = text.find("##", at)) != std::string::npos;)
    text.replace(at, 2, "#\\u0023");
  return text;
}

Json value_of(std::optional<double> value) { return value ? Json(*value) : Json(nullptr); }

Json rounded(double value) { return std::round(value * 1e9) / 1e9; }

void StatisticList::add(const std::string& name, std::string_view unit,
                        std::string_view description, Json value) {
  Json& entry = list_.emplace_back(Json::object());
  entry["name"] = name;
  entry["unit"] = unit;
  entry["description"] = description;
  entry["value"] = std::move(value);
}

void StatisticList::add_with_protocol(const std::string& name, std::string_view unit,
                                      std::string_view description, Json value,
                                      const std::string& protocol) {
  add(name, unit, description, std::move(value));
  list_.back()["protocol"] = protocol;
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
