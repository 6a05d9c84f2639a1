#include "platform_models/loader/varying_chip.h"

#include <utility>

#include "platform_models/loader/configure.h"
#include "platform_models/loader/override.h"
#include "platform_models/loader/rules.h"
#include "sim/base/check.h"
#include "sim/base/error.h"

namespace leviosim::platform {

VaryingChip::VaryingChip(const Schema& schema, Settings settings)
    : schema_(schema), settings_(std::move(settings)), config_(configure(schema, "", settings_)) {}

std::optional<double> VaryingChip::value_of(std::size_t field, std::string_view text) const {
  try {
    return read_override(schema_.fields()[field], settings_[field], text, Place{}).base;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

void VaryingChip::set(std::size_t field, double value, std::string_view text) {
  const std::vector<Field>& fields = schema_.fields();
  check(settings_[field].has_value(), "a varied parameter is one that the chip gives");
  settings_[field]->base = value;
  if (fields[field].is_choice()) settings_[field]->parameter.value = text;
  fields[field].set(config_, value);
  if (!fields[field].path.starts_with("isa.")) return;
  // What is different for some cores stands behind what all have in common, and holds.
  for (std::size_t i = field + 1; i < fields.size(); ++i)
    if (settings_[i]) fields[i].set(config_, settings_[i]->base);
}

bool VaryingChip::is_possible() const {
  try {
    check_values(schema_, settings_, config_);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace leviosim::platform
