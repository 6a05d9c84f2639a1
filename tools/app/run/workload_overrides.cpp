#include "tools/app/run/workload_overrides.h"

#include <fmt/core.h>

#include <algorithm>

#include "platform_models/loader/dimension.h"
#include "sim/base/error.h"
#include "sim/base/nearest.h"

namespace leviosim::tools {
namespace {

using vio::Parameter;

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const Parameter& p : vio::parameters()) all.emplace_back(p.name);
  return all;
}

}  // namespace

SplitOverrides split_overrides(const std::vector<std::string>& overrides) {
  SplitOverrides split;
  for (const std::string& text : overrides)
    (platform::trim(text).starts_with(vio::kParameterPrefix) ? split.workload : split.chip)
        .push_back(text);
  return split;
}

std::vector<vio::Assignment> parse_workload_overrides(const std::vector<std::string>& overrides) {
  std::vector<vio::Assignment> assignments;
  for (const std::string& text : overrides) {
    const std::string where = "-p " + text;
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos)
      throw InputError(where + ": expected path=value, such as workload.window=6");
    const Parameter& parameter =
        workload_parameter(where, std::string(platform::trim(text.substr(0, equals))));
    for (const vio::Assignment& other : assignments)
      if (other.parameter == &parameter)
        throw InputError(fmt::format("{}: '{}' is already given", where, parameter.name));
    assignments.push_back(
        {&parameter, parse_workload_value(where, parameter, text.substr(equals + 1))});
  }
  return assignments;
}

const Parameter& workload_parameter(const std::string& where, const std::string& name) {
  const Parameter* const parameter = vio::find_parameter(name);
  if (parameter == nullptr)
    throw InputError(fmt::format("{}: the workload has no parameter '{}'{}", where, name,
                                 base::did_you_mean(name, names())));
  return *parameter;
}

double parse_workload_value(const std::string& where, const Parameter& parameter,
                            const std::string& text) {
  const std::string_view value = platform::trim(text);
  const auto fail = [&] {
    throw InputError(fmt::format("{}: '{}' is no value of {}; expected {}", where, value,
                                 parameter.name, valid_values(parameter)));
  };
  if (parameter.kind == Parameter::Kind::toggle) {
    if (value != "off" && value != "on") fail();
    return value == "on" ? 1 : 0;
  }
  const std::optional<platform::Measure> measure = platform::split_measure(value);
  if (!measure || (!measure->unit.empty() && measure->unit != parameter.unit) ||
      !vio::is_valid(parameter, measure->number))
    fail();
  return measure->number;
}

std::string valid_values(const Parameter& parameter) {
  if (parameter.kind == Parameter::Kind::toggle) return "off or on";
  const std::string kind = parameter.kind == Parameter::Kind::whole ? "a whole number" : "a number";
  const std::string of = parameter.unit.empty() ? "" : fmt::format(" of {}", parameter.unit);
  return fmt::format("{}{} from {} to {}", kind, of, vio::value_text(parameter, parameter.low),
                     vio::value_text(parameter, parameter.high));
}

}  // namespace leviosim::tools
