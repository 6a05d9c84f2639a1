#include "platform_models/loader/configure.h"

#include "platform_models/loader/compiled_code.h"

namespace leviosim::platform {

sim::ChipConfig configure(const Schema& schema, const std::string& name, const Settings& settings) {
  sim::ChipConfig config;
  config.name = name;
  for (std::size_t i = 0; i < schema.fields().size(); ++i) {
    const Field& field = schema.fields()[i];
    const auto& setting = settings[i];
    if (!setting) continue;
    field.set(config, setting->base);
    const auto& range = setting->parameter.range;
    if (!range || !field.set_band) continue;
    const double factor = field.dimension->find(setting->parameter.unit)->factor;
    field.set_band(config, range->low * factor, range->high * factor);
  }
  config.cluster.icache.measured_size = size_of_code(config.cluster.core.code);
  config.controller.icache.measured_size = size_of_code(config.controller.core.code);
  return config;
}

}  // namespace leviosim::platform
