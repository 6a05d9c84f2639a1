#include "platform_models/loader/variants.h"

#include <fmt/format.h>

#include <utility>

#include "platform_models/loader/parameter.h"
#include "platform_models/loader/platform_file.h"
#include "platform_models/loader/rules.h"
#include "platform_models/loader/value.h"
#include "sim/base/check.h"
#include "sim/base/nearest_name.h"

namespace leviosim::platform {

Variants::Variants(ResolvedPlatform platform) : platform_(std::move(platform)) {
  settings_.resize(schema_.fields().size());
  for (const Parameter& parameter : platform_.parameters) {
    const std::size_t index = schema_.find(parameter.path);
    check(index != Schema::kNone, "a resolved parameter is not in the schema");
    Setting setting =
        read_value(schema_.fields()[index], parameter.value, parameter.unit, Place{parameter.path});
    setting.where = "platform " + platform_.name;
    setting.parameter = parameter;
    settings_[index] = std::move(setting);
  }
}

const Parameter* Variants::find(const std::string& path) const {
  const std::size_t index = schema_.find(path);
  if (index == Schema::kNone || !settings_[index]) return nullptr;
  return &settings_[index]->parameter;
}

Settings Variants::changed(const std::vector<Change>& changes) const {
  Settings settings = settings_;
  for (const Change& change : changes) {
    const std::size_t index = schema_.find(change.path);
    const Place place{fmt::format("{} = {}", change.path, number_text(change.value))};
    if (index == Schema::kNone)
      place.fail("unknown parameter" + base::did_you_mean(change.path, schema_.paths()));
    if (!settings[index]) place.fail("the platform does not give this parameter");
    Setting& setting = *settings[index];
    const Setting read = read_value(schema_.fields()[index], number_text(change.value),
                                    setting.parameter.unit, place);
    setting.base = read.base;
    setting.parameter.value = read.parameter.value;
    setting.where = "a variant";
  }
  return settings;
}

sim::ChipConfig Variants::config(const std::vector<Change>& changes) const {
  const Settings settings = changed(changes);
  const sim::ChipConfig config = configure(schema_, platform_.name, settings);
  check_values(schema_, settings, config);
  return config;
}

}  // namespace leviosim::platform
