#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "platform_models/loader/value.h"
#include "sim/base/error.h"
#include "tools/app/study/whatif/whatif.h"

namespace leviosim::tools {
namespace {

/// Sections that are no resources of the chip.
constexpr std::array<std::string_view, 4> kNotHardware{"energy.", "area.", "supply.", "isa."};
/// Shapes of caches and bursts: no amounts.
constexpr std::array<std::string_view, 5> kShapes{".line", ".ways", ".burst", ".max_workers",
                                                  ".workers"};

bool is_resource(const platform::Schema& schema, const platform::Parameter& parameter) {
  const std::string_view path = parameter.path;
  for (const std::string_view section : kNotHardware)
    if (path.starts_with(section)) return false;
  for (const std::string_view shape : kShapes)
    if (path.ends_with(shape)) return false;
  const platform::Dimension* dimension = schema.fields()[schema.find(path)].dimension;
  return dimension == &platform::kSize || dimension == &platform::kBanks ||
         dimension == &platform::kUnits || dimension == &platform::kRate;
}

/// "cluster.l1.banks=32", "cluster.l1.size=256KiB": a count goes without its unit.
Variant changed(const platform::Schema& schema, const platform::Parameter& parameter,
                double factor) {
  const platform::Dimension& dimension = *schema.fields()[schema.find(parameter.path)].dimension;
  const double value = *platform::parse_number(parameter.value) * factor;
  const std::string text =
      platform::number_text(value) + (dimension.units.size() > 1 ? parameter.unit : "");
  return {fmt::format("{}={}", parameter.path, text),
          {{std::string(kChipSettings) + parameter.path, text}}};
}

/// Whole numbers stay whole, and nothing vanishes.
bool may_be(const platform::Schema& schema, const platform::Parameter& parameter, double factor) {
  const platform::Field& field = schema.fields()[schema.find(parameter.path)];
  const double value = *platform::parse_number(parameter.value) * factor;
  const double unit = field.dimension->find(parameter.unit)->factor;
  const bool whole = field.dimension == &platform::kRate || value * unit == std::floor(value * unit);
  return value > 0 && whole;
}

const platform::Parameter* find(const platform::ResolvedPlatform& chip, std::string_view path) {
  const auto it = std::find_if(chip.parameters.begin(), chip.parameters.end(),
                               [&](const platform::Parameter& p) { return p.path == path; });
  return it == chip.parameters.end() ? nullptr : &*it;
}

/// Accelerators that a built-in platform has on top of this chip.
std::optional<Variant> with_accelerators_of(const std::string& name,
                                            const platform::ResolvedPlatform& chip) {
  Variant variant{name + "'s units", {}};
  const platform::ResolvedPlatform other = platform::resolve_platform(name);
  for (const platform::Parameter& parameter : other.parameters) {
    if (find(chip, parameter.path) != nullptr) continue;
    if (parameter.path.find(".accelerators.") == std::string::npos) return std::nullopt;
    variant.settings[std::string(kChipSettings) + parameter.path] = parameter.value + parameter.unit;
  }
  if (variant.settings.empty() || other.parameters.size() < chip.parameters.size())
    return std::nullopt;
  return variant;
}

Variant with_cores(int workers, int most) {
  Variant variant{fmt::format("cluster.workers={}", workers),
                  {{"platform.cluster.workers", fmt::format("{}", workers)}}};
  if (workers > most) {
    variant.name += fmt::format(",cluster.max_workers={}", workers);
    variant.settings["platform.cluster.max_workers"] = fmt::format("{}", workers);
  }
  return variant;
}

}  // namespace

std::vector<Variant> WhatIf::standard_variants() {
  const platform::ResolvedPlatform chip = plan_.reference->resolve({});
  const platform::Schema& schema = plan_.reference->schema();
  std::vector<Variant> all;
  for (const platform::Parameter& parameter : chip.parameters)
    if (is_resource(schema, parameter))
      for (const double factor : {0.5, 2.0})
        if (may_be(schema, parameter, factor)) all.push_back(changed(schema, parameter, factor));
  const platform::Parameter* cluster = find(chip, "cluster.clock");
  const platform::Parameter* controller = find(chip, "controller.clock");
  for (const double factor : {0.5, 2.0}) {
    const Variant slow = changed(schema, *cluster, factor);
    const Variant both = changed(schema, *controller, factor);
    Variant variant{slow.name + ',' + both.name, slow.settings};
    variant.settings.insert(both.settings.begin(), both.settings.end());
    all.push_back(std::move(variant));
  }
  const sim::ClusterConfig& team = chip.config.cluster;
  if (!again_.empty() && team.workers > 1)
    for (const int workers : {team.workers / 2, team.workers * 2})
      all.push_back(with_cores(workers, team.max_workers));
  for (const std::string& name : platform::platform_names())
    if (auto variant = with_accelerators_of(name, chip)) all.push_back(*std::move(variant));
  return all;
}

}  // namespace leviosim::tools
