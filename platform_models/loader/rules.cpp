#include "platform_models/loader/rules.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "platform_models/loader/accelerator_fields.h"
#include "platform_models/loader/supply_rules.h"
#include "sim/base/error.h"
#include "sim/energy/area.h"
#include "sim/work/op.h"

namespace leviosim::platform {
namespace {

class Rules {
 public:
  Rules(const Schema& schema, const Settings& settings) : schema_(schema), settings_(settings) {}

  std::string state(std::string_view path) const {
    return platform::state(settings_[schema_.find(path)].value());
  }

  void require(bool ok, std::string_view path, std::string_view expected) const {
    if (!ok) throw InputError(fmt::format("{}: expected {}", state(path), expected));
  }

  /// No operation of the cluster's cores may need a unit that the cluster does not have.
  void require_units(std::string_view choice, std::string_view count_path, int count) const {
    if (count > 0) return;
    for (std::size_t i = 0; i < schema_.fields().size(); ++i) {
      const Field& field = schema_.fields()[i];
      const auto& setting = settings_[i];
      if (!setting || field.name != "on" || setting->parameter.value != choice) continue;
      if (field.path.rfind("controller.", 0) == 0) continue;
      if (field.path.rfind("isa.", 0) == 0 && replaced(field)) continue;
      throw InputError(
          fmt::format("{}, but {}: expected at least one, or what the operation costs "
                      "without it and on: core",
                      state(count_path), state(field.path)));
    }
  }

  /// Lines of a cache are addressed by bits, and each way of a cache has at least one.
  void require_lines(const std::string& path, const sim::InstructionCacheConfig& cache,
                     const std::vector<std::pair<std::string, Bytes>>& sizes) const {
    if (cache.line == Bytes(0)) return;
    require(std::has_single_bit(static_cast<std::uint64_t>(cache.line.count())), path + ".line",
            "a power of two");
    for (const auto& [name, size] : sizes)
      if (size != Bytes(0) && size.count() < cache.line.count() * cache.ways)
        throw InputError(fmt::format("{}: expected at least {} B, a line for each of {} ways",
                                     state(path + "." + name), cache.line.count() * cache.ways,
                                     cache.ways));
  }

  /// A core that is alone never waits for itself: what an operation occupies its unit for must fit
  /// into what it costs the core. (A pipelined unit is busy for one cycle, whatever the latency.)
  void require_latency(const work::OpInfo& info, const sim::OpCost& cost) const {
    if (cost.unit == sim::Unit::Core || cost.busy <= 1 || cost.busy <= cost.issue + cost.stall)
      return;
    const auto of = [&](std::string_view column) {
      const std::string own = fmt::format("cluster.core.ops.{}.{}", info.name, column);
      return state(settings_[schema_.find(own)] ? own
                                                : fmt::format("isa.ops.{}.{}", info.name, column));
    };
    throw InputError(
        fmt::format("{}, but {} and {}: expected issue + stall to cover the time that "
                    "the operation occupies its unit",
                    of("busy"), of("issue"), of("stall")));
  }

 private:
  /// Whether the cluster has a value of its own in place of this one of `isa`.
  bool replaced(const Field& field) const {
    const std::string own = "cluster.core" + field.path.substr(std::string_view("isa").size());
    return settings_[schema_.find(own)].has_value();
  }

  const Schema& schema_;
  const Settings& settings_;
};

}  // namespace

std::string state(const Setting& setting) {
  const Parameter& p = setting.parameter;
  return fmt::format("{} is {}{}{} ({})", p.path, p.value, p.unit.empty() ? "" : " ", p.unit,
                     setting.where);
}

void check_values(const Schema& schema, const Settings& settings, const sim::ChipConfig& chip) {
  const Rules rules(schema, settings);
  const sim::ClusterConfig& cluster = chip.cluster;
  if (cluster.workers > cluster.max_workers)
    throw InputError(
        fmt::format("{}, but {}: expected no more workers than the event unit serves; a larger "
                    "cluster.max_workers serves more",
                    rules.state("cluster.workers"), rules.state("cluster.max_workers")));
  if (chip.controller.shares_core && cluster.max_workers > 1)
    throw InputError(fmt::format("{}, but {}: expected a chip with one core",
                                 rules.state("controller.runs_on"),
                                 rules.state("cluster.max_workers")));
  if (chip.controller.shares_core && chip.controller.clock != cluster.clock)
    throw InputError(fmt::format("{}, but {}: expected the same, for the chip has one core",
                                 rules.state("controller.clock"), rules.state("cluster.clock")));
  rules.require(std::has_single_bit(static_cast<unsigned>(cluster.l1.banks)), "cluster.l1.banks",
                "a power of two");
  rules.require_lines("cluster.icache", cluster.icache,
                      {{"size", cluster.icache.worker},
                       {"master_size", cluster.icache.master},
                       {"shared_size", cluster.icache.shared}});
  rules.require_lines("controller.icache", chip.controller.icache,
                      {{"size", chip.controller.icache.worker}});
  if (settings[schema.find("area.gate")])
    rules.require(sim::knows_area(chip), "area.gate", "more than 0");
  rules.require_units("fpu", "cluster.fpu.units", cluster.fpu.units);
  rules.require_units("divider", "cluster.fpu.dividers", cluster.fpu.dividers);
  rules.require_units("int64", "cluster.fpu.int64_units", cluster.fpu.int64_units);
  for (const work::OpInfo& info : work::kOps) rules.require_latency(info, cluster.core[info.op]);
  check_supply(schema, settings, chip);
  check_accelerators(schema, settings, chip);
}

void check_rules(const Schema& schema, const Settings& settings, const sim::ChipConfig& chip) {
  check_energy_is_whole(schema, settings);
  check_accelerators_are_whole(schema, settings, chip);
  check_values(schema, settings, chip);
}

}  // namespace leviosim::platform
