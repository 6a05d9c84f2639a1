#include "platform_models/loader/override.h"

#include <fmt/format.h>

#include "platform_models/loader/instruction_set.h"
#include "platform_models/loader/parameter.h"
#include "platform_models/loader/value.h"
#include "sim/base/text.h"

namespace leviosim::platform {
namespace {

/// A name for an unknown path: of a parameter that was nearly meant, or those inside of a section
/// or row.
std::string what_is_meant(const Schema& schema, const std::string& path) {
  const std::vector<std::string> paths = schema.paths();
  for (const std::string& known : paths)
    if (known.rfind(path + ".", 0) == 0)
      return fmt::format("has keys of its own, such as '{}'", known);
  return why_unknown(path, paths);
}

std::string default_unit(const Field& field, const std::optional<Setting>& previous) {
  if (field.is_choice()) return {};
  return previous ? previous->parameter.unit : std::string(field.dimension->units[0].name);
}

}  // namespace

SplitOverrides split_overrides(const std::vector<std::string>& overrides) {
  SplitOverrides split;
  for (const std::string& text : overrides) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos ||
        trim(std::string_view(text).substr(0, equals)) != kBasePath) {
      split.parameters.push_back(text);
      continue;
    }
    const Place place{"-p " + text};
    if (split.base)
      place.fail(fmt::format("'{}' is already given by {}", kBasePath, split.base->where));
    split.base = {std::string(trim(std::string_view(text).substr(equals + 1))), place.where};
    if (split.base->base.empty()) place.fail("expected a value after '='");
  }
  return split;
}

Setting read_override(const Field& field, const std::optional<Setting>& replaced,
                      std::string_view value, const Place& place) {
  std::string unit = default_unit(field, replaced);
  std::string_view number = value;
  if (!field.is_choice()) {
    const std::optional<Measure> measure = split_measure(value);
    if (measure && !measure->unit.empty()) {
      unit = std::string(measure->unit);
      number = trim(value.substr(0, value.size() - unit.size()));
    }
  }
  return read_value(field, number, unit, place);
}

void apply_override(const Schema& schema, Settings& settings, const std::string& text) {
  const Place place{"-p " + text};
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) place.fail("expected path=value, such as cluster.workers=4");
  const std::string path(trim(std::string_view(text).substr(0, equals)));
  const std::string_view value = trim(std::string_view(text).substr(equals + 1));
  const std::size_t index = schema.find(path);
  if (index == Schema::kNone) place.fail(what_is_meant(schema, path));
  if (value.empty()) place.fail("expected a value after '='");

  const Field& field = schema.fields()[index];
  std::optional<Setting>& setting = settings[index];
  if (setting && setting->parameter.overridden)
    place.fail(fmt::format("'{}' is already given by {}", path, setting->where));
  setting = read_override(field, setting, value, place);
  setting->where = place.where;
  setting->parameter.source = kOverrideSource;
  setting->parameter.confidence = "assumed";
  setting->parameter.overridden = true;
}

}  // namespace leviosim::platform
