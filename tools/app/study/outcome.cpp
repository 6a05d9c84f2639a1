#include "tools/app/study/outcome.h"

#include "tools/app/report/statistic_list.h"

namespace leviosim::tools {
namespace {

constexpr const char* kFormat = "leviosim outcome 1";

}  // namespace

std::string to_text(const Outcome& outcome) {
  Json json;
  json["format"] = kFormat;
  json["failure"] = outcome.failure;
  json["protocol"] = outcome.protocol;
  json["figures"] = Json::array();
  for (const Figure& f : outcome.figures)
    json["figures"].push_back(Json::array({f.name, f.unit, f.description, f.value}));
  return json_text(json) + '\n';
}

std::optional<Outcome> parse_outcome(std::string_view text) {
  try {
    const Json json = Json::parse(text);
    if (json.at("format") != kFormat) return std::nullopt;
    Outcome outcome{
        json.at("failure").get<std::string>(), {}, json.at("protocol").get<std::string>()};
    for (const Json& f : json.at("figures"))
      outcome.figures.push_back({f.at(0).get<std::string>(), f.at(1).get<std::string>(),
                                 f.at(2).get<std::string>(), f.at(3).get<double>()});
    return outcome;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

}  // namespace leviosim::tools
