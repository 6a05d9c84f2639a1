#include "tools/app/interactive/knobs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "platform_models/loader/loader.h"
#include "sim/energy/supply.h"

namespace leviosim::tools {
namespace {

enum class Steps {
  doubled,  ///< powers of two times the recorded value
  even,     ///< from a fifth to one and a half of it
  supply    ///< what the chip's supply can be set to
};
/// Whose other values are not in recorded work.
constexpr std::string_view kCores = "cluster.workers";
struct KnobRow {
  std::string_view path;
  Steps steps = Steps::doubled;
};
/// In the order of the page.
constexpr std::array kKnobs{KnobRow{"cluster.clock", Steps::even},
                            KnobRow{"controller.clock", Steps::even},
                            KnobRow{"supply.voltage", Steps::supply},
                            KnobRow{kCores},
                            KnobRow{"cluster.fpu.units"},
                            KnobRow{"cluster.fpu.dividers"},
                            KnobRow{"cluster.l1.size"},
                            KnobRow{"cluster.l1.banks"},
                            KnobRow{"cluster.icache.size"},
                            KnobRow{"cluster.icache.shared_size"},
                            KnobRow{"cluster.icache.refill_width"},
                            KnobRow{"cluster.dma.bytes_per_cycle"}};
constexpr int kMostDoublings = 3;
constexpr int kMostVoltages = 20;

const platform::Parameter* find(const platform::ResolvedPlatform& chip, std::string_view path) {
  const auto it = std::find_if(chip.parameters.begin(), chip.parameters.end(),
                               [&](const platform::Parameter& p) { return p.path == path; });
  return it == chip.parameters.end() ? nullptr : &*it;
}

/// In the unit of the parameter, with the recorded one.
std::set<double> values_of(Steps steps, double recorded, const sim::SupplyConfig& supply) {
  std::set<double> values{recorded};
  if (steps == Steps::doubled)
    for (int n = 1; n <= kMostDoublings; ++n) {
      values.insert(recorded * std::exp2(n));
      values.insert(recorded * std::exp2(-n));
    }
  else if (steps == Steps::supply)
    for (int n = 0; supply.step > Volts(0) && n <= kMostVoltages; ++n) {
      const Volts voltage = supply.lowest.voltage + supply.step * n;
      if (sim::can_supply(supply, voltage)) values.insert(std::round(voltage.count() * 1e6) / 1e6);
    }
  else
    for (int n = 8; n <= 60; ++n) {
      const double step = std::pow(10, std::floor(std::log10(recorded)) - 1);  // of a round size
      values.insert(std::round(recorded * n / 40 / step) * step);
    }
  return values;
}

bool is_allowed(const platform::Field& field, double value, double factor) {
  const double base = value * factor;
  return base >= field.min && base <= field.max &&
         (!field.dimension->whole || base == std::round(base));
}

Json knob_json(const platform::Field& field, const platform::Parameter& parameter, Steps steps,
               const sim::SupplyConfig& supply) {
  const double recorded = *platform::parse_number(parameter.value);
  const double factor = field.dimension->find(parameter.unit)->factor;
  const bool has_units = field.dimension->units.size() > 1;
  Json knob{{"path", field.path},
            {"help", field.description},
            {"unit", parameter.unit},
            {"values", Json::array()}};
  if (field.path == kCores)
    knob["fixed"] =
        "A recording holds the work as it was divided, with as many hypotheses and tiles as there "
        "were cores. For others the flight is computed anew:";
  for (const double value : values_of(steps, recorded, supply)) {
    if (!is_allowed(field, value, factor)) continue;
    if (value == recorded) knob["recorded"] = knob["values"].size();
    knob["values"].push_back(platform::number_text(value) + (has_units ? parameter.unit : ""));
  }
  return knob;
}

/// The rate of the camera, which is no parameter of the chip.
Json camera_json(double recorded) {
  Json knob{{"path", "fps"},
            {"help", "frames that the camera delivers in a second; none is lost, they wait"},
            {"unit", ""},
            {"values", Json::array()}};
  std::set<double> rates{recorded};
  for (int rate = 5; rate <= std::max(120.0, 2 * recorded); rate += 5) rates.insert(rate);
  for (const double rate : rates) {
    if (rate == recorded) knob["recorded"] = knob["values"].size();
    knob["values"].push_back(platform::number_text(rate));
  }
  return knob;
}

}  // namespace

Json knobs_json(const platform::Schema& schema, const platform::ResolvedPlatform& chip,
                std::int64_t period_ns) {
  Json knobs = Json::array();
  for (const KnobRow& row : kKnobs)
    if (const platform::Parameter* parameter = find(chip, row.path))
      knobs.push_back(knob_json(schema.fields()[schema.find(row.path)], *parameter, row.steps,
                                chip.config.supply));
  knobs.push_back(camera_json(1e9 / static_cast<double>(period_ns)));
  return knobs;
}

Json switches_json(const platform::ResolvedPlatform& chip) {
  Json switches = Json::array();
  for (const std::string& name : platform::platform_names()) {
    const platform::ResolvedPlatform other = platform::resolve_platform(name);
    if (other.parameters.size() <= chip.parameters.size()) continue;
    Json settings = Json::array();
    bool is_of_chip = true;
    for (const platform::Parameter& parameter : other.parameters) {
      if (find(chip, parameter.path) != nullptr) continue;
      is_of_chip = is_of_chip && parameter.path.find(".accelerators.") != std::string::npos;
      settings.push_back(parameter.path + '=' + parameter.value + parameter.unit);
    }
    if (is_of_chip && !settings.empty())
      switches.push_back(
          {{"name", name}, {"help", other.description}, {"settings", std::move(settings)}});
  }
  return switches;
}

}  // namespace leviosim::tools
