#include "tools/app/study/sweep/sweep_key.h"

#include <fmt/core.h>

#include <array>
#include <limits>

#include "platform_models/loader/instruction_set.h"
#include "platform_models/loader/parameter_units.h"
#include "sim/base/nearest_name.h"
#include "tools/app/cli/command_line.h"
#include "tools/app/run/run_options.h"
#include "tools/app/run/workload_options.h"

namespace leviosim::tools {
namespace {

using Kind = SweepKey::Kind;

constexpr std::string_view kChipPrefix = "platform.";

struct Word {
  std::string_view name;
  Kind kind;
};

constexpr std::array kWords{Word{"platform", Kind::platform}, Word{"profile", Kind::profile},
                            Word{"data", Kind::data},         Word{"trace", Kind::trace},
                            Word{"seed", Kind::seed},         Word{"size", Kind::size},
                            Word{"frames", Kind::frames},     Word{"cores", Kind::cores}};

std::vector<std::string> all_names(const platform::Schema& schema) {
  std::vector<std::string> names;
  for (const Word& word : kWords) names.emplace_back(word.name);
  for (const vio::Parameter& p : vio::parameters()) names.emplace_back(p.name);
  for (const std::string& path : schema.paths()) names.push_back(std::string(kChipPrefix) + path);
  return names;
}

const platform::Field& field_of(const SweepKey& key, const platform::Schema& schema) {
  return schema.fields()[schema.find(key.path)];
}

/// The unit that the chip's file gives the parameter, else the base unit.
std::string reference_unit(const SweepKey& key, platform::PlatformFile& reference) {
  const platform::Parameter* const known = reference.find(key.path);
  if (known != nullptr) return known->unit;
  return std::string(field_of(key, reference.schema()).dimension->units[0].name);
}

platform::Setting read_chip_value(const SweepKey& key, std::string_view text,
                                  platform::PlatformFile& reference, const platform::Place& place) {
  const platform::Field& field = field_of(key, reference.schema());
  if (field.is_choice()) return platform::read_value(field, text, "", place);
  const std::optional<platform::Measure> measure = platform::split_measure(text);
  if (!measure || measure->unit.empty())
    return platform::read_value(field, text, reference_unit(key, reference), place);
  const std::string_view number =
      platform::trim(text.substr(0, text.size() - measure->unit.size()));
  return platform::read_value(field, number, measure->unit, place);
}

std::int64_t most_of(Kind kind) {
  return kind == Kind::seed ? std::numeric_limits<std::uint32_t>::max()
                            : std::numeric_limits<int>::max();
}

using platform::Place;

}  // namespace

bool SweepKey::is_number(const platform::Schema& schema) const {
  switch (kind) {
    case Kind::chip:
      return !field_of(*this, schema).is_choice();
    case Kind::workload:
      return parameter->kind != vio::Parameter::Kind::toggle;
    case Kind::seed:
    case Kind::cores:
      return true;
    default:
      return false;
  }
}

bool SweepKey::belongs_to_recording() const {
  return kind == Kind::workload || kind == Kind::profile || kind == Kind::data ||
         kind == Kind::seed || kind == Kind::size || kind == Kind::frames;
}

SweepKey find_key(const std::string& name, const platform::Schema& schema,
                  const platform::Place& place) {
  for (const Word& word : kWords)
    if (word.name == name) return {word.kind, name};
  if (const vio::Parameter* parameter = vio::find_parameter(name))
    return {Kind::workload, name, {}, parameter};
  if (name.starts_with(kChipPrefix)) {
    const std::string path = name.substr(kChipPrefix.size());
    if (path == platform::kBasePath) return {Kind::instruction_set, name, path};
    if (schema.find(path) != platform::Schema::kNone) return {Kind::chip, name, path};
  }
  place.fail("unknown key" + base::did_you_mean(name, all_names(schema)));
}

std::string SweepNumber::text() const { return platform::number_text(value) + unit; }

SweepNumber chip_number(const SweepKey& key, double base, platform::PlatformFile& reference) {
  const std::string unit = reference_unit(key, reference);
  const double factor = field_of(key, reference.schema()).dimension->find(unit)->factor;
  return {base / factor, factor, unit};
}

SweepNumber number_of(const SweepKey& key, const std::string& text,
                      platform::PlatformFile& reference, const platform::Place& place) {
  if (key.kind == Kind::chip)
    return chip_number(key, read_chip_value(key, text, reference, place).base, reference);
  if (key.kind == Kind::workload)
    return {parse_workload_value(place.where, *key.parameter, text), 1, {}};
  SweepNumber number;
  read_at(place, [&] {
    number.value = static_cast<double>(
        parse_whole(key.name, text, key.kind == Kind::cores ? 1 : 0, most_of(key.kind)));
  });
  return number;
}

std::string normal_value(const SweepKey& key, const std::string& text,
                         platform::PlatformFile& reference, const platform::Place& place) {
  const std::string value(platform::trim(text));
  if (value.empty()) place.fail("is empty; expected a value");
  switch (key.kind) {
    case Kind::chip: {
      const platform::Setting setting = read_chip_value(key, value, reference, place);
      if (field_of(key, reference.schema()).is_choice()) return setting.parameter.value;
      return chip_number(key, setting.base, reference).text();
    }
    case Kind::workload:
      return vio::value_text(*key.parameter,
                             parse_workload_value(place.where, *key.parameter, value));
    case Kind::seed:
    case Kind::cores:
      return number_of(key, value, reference, place).text();
    case Kind::profile:
      read_at(place, [&] { vio::expect_profile(value); });
      return value;
    case Kind::size:
      read_at(place, [&] { parse_size(value); });
      return value;
    case Kind::frames:
      read_at(place, [&] { traces::parse_frame_range(value); });
      return value;
    default:
      return value;  // names of files: checked when they are opened
  }
}

std::string without_count_unit(const std::string& value) {
  const auto measure = platform::split_measure(value);
  const bool is_count = measure && (measure->unit == "units" || measure->unit == "banks" ||
                                    measure->unit == "cores" || measure->unit == "ways");
  return is_count ? value.substr(0, value.size() - measure->unit.size()) : value;
}

}  // namespace leviosim::tools
