#include "platform_models/loader/supply_rules.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "platform_models/loader/energy_fields.h"
#include "platform_models/loader/rules.h"
#include "sim/base/error.h"
#include "sim/energy/supply.h"

namespace leviosim::platform {
namespace {

std::string megahertz(Hertz clock) {
  return fmt::format("{:g} MHz", static_cast<double>(clock.count()) * 1e-6);
}

std::string volts(Volts voltage) { return fmt::format("{:g} V", voltage.count()); }

class SupplyRules {
 public:
  SupplyRules(const Schema& schema, const Settings& settings, const sim::SupplyConfig& supply)
      : schema_(schema), settings_(settings), supply_(supply) {}

  void all_or_none() const {
    require_whole({EnergyGroup::Area}, "the section area in full, or none of it");
    const Setting* area = first_given(EnergyGroup::Area);
    const Setting* fixed = first_given(EnergyGroup::Fixed);
    if (area != nullptr && fixed != nullptr)
      throw InputError(
          fmt::format("{}, but {}: expected leakage and clock by size (energy.by_size) on a chip "
                      "with areas, and no fixed amounts beside them",
                      state(*fixed), state(*area)));
    require_whole({EnergyGroup::Always, area ? EnergyGroup::BySize : EnergyGroup::Fixed},
                  "the sections supply and energy in full, or neither");
    const Setting* by_size = first_given(EnergyGroup::BySize);
    if (area == nullptr && by_size != nullptr)
      throw InputError(fmt::format("{}: expected the section area, too", state(*by_size)));
  }

  void points_in_order() const {
    if (supply_.lowest.voltage > supply_.highest.voltage)
      contradict("supply.lowest.voltage", "supply.highest.voltage", "no more than that");
    if (supply_.lowest.clock > supply_.highest.clock)
      contradict("supply.lowest.clock", "supply.highest.clock", "no more than that");
  }

  void voltage_exists() const {
    if (sim::can_supply(supply_, supply_.voltage)) return;
    throw InputError(fmt::format("{}: expected {} to {} in steps of {}", of("supply.voltage"),
                                 volts(supply_.lowest.voltage), volts(supply_.highest.voltage),
                                 volts(supply_.step)));
  }

  /// A voltage allows clocks up to a limit; the message offers both ways out.
  void reaches_clocks(const sim::ChipConfig& chip) const {
    const Hertz limit = sim::highest_clock(supply_, supply_.voltage);
    const std::array clocks{std::pair{"cluster.clock", chip.cluster.clock},
                            std::pair{"controller.clock", chip.controller.clock}};
    std::vector<std::string> slower;
    for (const auto& [path, clock] : clocks)
      if (clock > limit)
        slower.push_back(
            fmt::format("{}={:.9g}MHz", path, static_cast<double>(limit.count()) * 1e-6));
    for (const auto& [path, clock] : clocks) {
      if (clock <= limit) continue;
      const auto voltage = sim::lowest_voltage(supply_, clock);
      contradict(
          path, "supply.voltage",
          fmt::format(
              "at most {}, as with {}; {}", megahertz(limit), fmt::join(slower, " and "),
              voltage ? fmt::format("{} needs supply.voltage={}", megahertz(clock), volts(*voltage))
                      : fmt::format("no voltage allows more than {}",
                                    megahertz(supply_.highest.clock))));
    }
  }

 private:
  const Setting* first_given(EnergyGroup group) const {
    for (std::size_t i = 0; i < schema_.fields().size(); ++i)
      if (settings_[i] && energy_group_of(schema_.fields()[i]) == group) return &*settings_[i];
    return nullptr;
  }

  void require_whole(const std::vector<EnergyGroup>& groups, std::string_view expected) const {
    const Setting* given = nullptr;
    const Field* missing = nullptr;
    for (std::size_t i = 0; i < schema_.fields().size(); ++i) {
      const Field& field = schema_.fields()[i];
      if (std::count(groups.begin(), groups.end(), energy_group_of(field)) == 0) continue;
      if (settings_[i])
        given = &*settings_[i];
      else if (missing == nullptr)
        missing = &field;
    }
    if (given != nullptr && missing != nullptr)
      throw InputError(fmt::format("{}, but {} is missing ({}): expected {}", state(*given),
                                   missing->path, missing->description, expected));
  }

  std::string of(std::string_view path) const { return state(*settings_[schema_.find(path)]); }

  [[noreturn]] void contradict(std::string_view a, std::string_view b,
                               std::string_view expected) const {
    throw InputError(fmt::format("{}, but {}: expected {}", of(a), of(b), expected));
  }

  const Schema& schema_;
  const Settings& settings_;
  const sim::SupplyConfig& supply_;
};

}  // namespace

void check_energy_is_whole(const Schema& schema, const Settings& settings) {
  SupplyRules(schema, settings, {}).all_or_none();
}

void check_supply(const Schema& schema, const Settings& settings, const sim::ChipConfig& chip) {
  if (!settings[schema.find("supply.voltage")]) return;
  const SupplyRules rules(schema, settings, chip.supply);
  rules.points_in_order();
  rules.voltage_exists();
  rules.reaches_clocks(chip);
}

}  // namespace leviosim::platform
