#include "tools/app/record/statistic_list.h"

namespace leviosim::tools {
namespace {

/// Of documents of statistics.
constexpr int kStatisticsVersion = 8;

Json statistic_json(const Statistic& statistic) {
  Json json = Json::array({number_json(statistic.value), statistic.unit});
  if (statistic.description.empty() && statistic.protocol.empty()) return json;
  json.push_back(statistic.description);
  if (!statistic.protocol.empty()) json.push_back(statistic.protocol);
  return json;
}

}  // namespace

void StatisticList::add(const std::string& name, std::string_view unit,
                        std::string_view description, const Json& value,
                        const std::string& protocol) {
  Statistic& row = rows_.emplace_back(
      Statistic{.name = name, .unit = std::string(unit), .description = std::string(description)});
  if (!value.is_null()) row.value = value.get<double>();
  row.protocol = protocol;
}

Json statistics_json(const std::vector<Statistic>& statistics) {
  Json json = Json::object();
  for (const Statistic& statistic : statistics)
    add_member(json, statistic.name, statistic_json(statistic));
  return json;
}

Json statistics_document(const std::vector<Statistic>& statistics, const Json& about) {
  Json document{{"format", "leviosim statistics"}, {"version", kStatisticsVersion}};
  document.update(about);
  document["statistics"] = statistics_json(statistics);
  return document;
}

}  // namespace leviosim::tools
