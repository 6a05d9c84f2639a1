#include "platform_models/loader/accelerator_fields.h"

#include <fmt/format.h>

#include <utility>

#include "platform_models/loader/member_values.h"
#include "platform_models/loader/rules.h"
#include "sim/base/error.h"
#include "sim/energy/model.h"

namespace leviosim::platform {
namespace {

using sim::AcceleratorConfig;
using sim::ChipConfig;
using sim::EnergyConfig;

// Limits that keep typing errors out.
constexpr double kMaxUnits = 1024;
constexpr double kMaxCycles = 1e9;  // as good as infinite
constexpr double kLeastRate = 1e-9;
constexpr double kMaxRate = 1e6;
constexpr double kMaxEnergy = 1e-3;  // joules

/// Of the cluster or of the controller.
struct Side {
  std::string_view section;
  sim::Accelerators& (*of)(ChipConfig&);
  EnergyConfig::Items EnergyConfig::*energies;
  sim::AreaConfig::Accelerators sim::AreaConfig::*areas;
  bool has_l1;
};
const std::array<Side, 2> kSides = {{
    {"cluster", [](ChipConfig& c) -> sim::Accelerators& { return c.cluster.accelerators; },
     &EnergyConfig::cluster_accelerators, &sim::AreaConfig::cluster_accelerators, true},
    {"controller", [](ChipConfig& c) -> sim::Accelerators& { return c.controller.accelerators; },
     &EnergyConfig::controller_accelerators, &sim::AreaConfig::controller_accelerators, false},
}};

std::string section_of(const Side& side, const work::OffloadKindInfo& kernel) {
  return fmt::format("{}.accelerators.{}", side.section, kernel.name);
}

Field row(const std::string& path, const Dimension& dimension, double min, double max,
          std::string description) {
  Field field;
  field.path = field.record = path;
  field.name = "value";
  field.dimension = &dimension;
  field.min = min;
  field.max = max;
  field.required = false;
  field.description = std::move(description);
  return field;
}

struct Number {
  const char* key;
  const Dimension* dimension;
  double min;
  double max;
  double AcceleratorConfig::*member;
  const char* description;
};
const std::array<Number, 4> kNumbers = {{
    {"start_up", &kCycles, 0, kMaxCycles, &AcceleratorConfig::start_up,
     "instructions of the calling core per call"},
    {"latency", &kCycles, 0, kMaxCycles, &AcceleratorConfig::latency,
     "cycles of a call besides those of its items"},
    {"items_per_cycle", &kRatio, kLeastRate, kMaxRate, &AcceleratorConfig::items_per_cycle,
     "items per cycle of a unit"},
    {"l1_words", &kRatio, 0, kMaxUnits, &AcceleratorConfig::l1_words,
     "words of L1 that a unit moves per cycle while it works"},
}};

Field field_of(const Side& side, const work::OffloadKindInfo& kernel, const Number& number) {
  const std::size_t k = work::index(kernel.kernel);
  Field field =
      row(fmt::format("{}.{}", section_of(side, kernel), number.key), *number.dimension, number.min,
          number.max, fmt::format("{}: {}", number.description, kernel.description));
  const auto member = number.member;
  const auto of = side.of;
  field.set = [=](ChipConfig& chip, double value) { of(chip)[k].*member = value; };
  field.get = [=](const ChipConfig& chip) { return of(const_cast<ChipConfig&>(chip))[k].*member; };
  return field;
}

Field units_of(const Side& side, const work::OffloadKindInfo& kernel) {
  const std::size_t k = work::index(kernel.kernel);
  Field field = row(section_of(side, kernel) + ".units", kUnits, 1, kMaxUnits,
                    fmt::format("number of accelerators: {}", kernel.description));
  const auto of = side.of;
  field.set = [=](ChipConfig& chip, double value) { of(chip)[k].units = static_cast<int>(value); };
  field.get = [=](const ChipConfig& chip) {
    return static_cast<double>(of(const_cast<ChipConfig&>(chip))[k].units);
  };
  return field;
}

/// A number with a band. @param all  the numbers of all kinds of kernel in the chip's `range`
template <class Range, class All>
Field banded(Field field, std::size_t k, Range ChipConfig::*range, All all) {
  field.set = [=](ChipConfig& chip, double value) {
    Range& r = chip.*range;
    for (auto* numbers : {&r.value, &r.low, &r.high}) put((numbers->*all)[k], value);
  };
  field.get = [=](const ChipConfig& chip) { return as_number(((chip.*range).value.*all)[k]); };
  field.set_band = [=](ChipConfig& chip, double low, double high) {
    put(((chip.*range).low.*all)[k], low);
    put(((chip.*range).high.*all)[k], high);
  };
  return field;
}

Field energy_of(const Side& side, const work::OffloadKindInfo& kernel) {
  return banded(row(section_of(side, kernel) + ".energy", kEnergy, 0, kMaxEnergy,
                    fmt::format("energy of a unit for an item ({}), memory aside", kernel.item)),
                work::index(kernel.kernel), &ChipConfig::energy, side.energies);
}

Field area_of(const Side& side, const work::OffloadKindInfo& kernel) {
  return banded(row(section_of(side, kernel) + ".area", kGates, 0, kMaxGates,
                    fmt::format("area of a unit; unknown if not given: {}", kernel.description)),
                work::index(kernel.kernel), &ChipConfig::area, side.areas);
}

/// Whether a platform may leave the number out and have the rest of the accelerator.
bool may_be_missing(const Field& field, bool knows_energy) {
  return field.dimension == &kGates || (field.dimension == &kEnergy && !knows_energy);
}

}  // namespace

std::vector<Field> accelerator_fields(std::string_view section) {
  std::vector<Field> fields;
  for (const Side& side : kSides) {
    if (side.section != section) continue;
    for (const work::OffloadKindInfo& kernel : work::kOffloadKinds) {
      fields.push_back(units_of(side, kernel));
      for (const Number& number : kNumbers)
        if (number.member != &AcceleratorConfig::l1_words || side.has_l1)
          fields.push_back(field_of(side, kernel, number));
      fields.push_back(energy_of(side, kernel));
      fields.push_back(area_of(side, kernel));
    }
  }
  return fields;
}

void check_accelerators_are_whole(const Schema& schema, const Settings& settings,
                                  const ChipConfig& chip) {
  const bool knows_energy = sim::knows_energy(chip);
  for (const Side& side : kSides)
    for (const work::OffloadKindInfo& kernel : work::kOffloadKinds) {
      const std::string section = section_of(side, kernel) + ".";
      const Setting* given = nullptr;
      const Field* missing = nullptr;
      for (std::size_t i = 0; i < schema.fields().size(); ++i) {
        if (schema.fields()[i].path.rfind(section, 0) != 0) continue;
        if (settings[i])
          given = &*settings[i];
        else if (missing == nullptr && !may_be_missing(schema.fields()[i], knows_energy))
          missing = &schema.fields()[i];
      }
      if (given != nullptr && missing != nullptr)
        throw InputError(
            fmt::format("{}, but {} is missing ({}): expected all of an accelerator, or nothing",
                        state(*given), missing->path, missing->description));
    }
}

void check_accelerators(const Schema& schema, const Settings& settings, const ChipConfig& chip) {
  for (const Side& side : kSides) {
    if (!side.has_l1) continue;
    for (const work::OffloadKindInfo& kernel : work::kOffloadKinds) {
      const AcceleratorConfig& accelerator =
          side.of(const_cast<ChipConfig&>(chip))[work::index(kernel.kernel)];
      if (accelerator.units == 0 || accelerator.l1_words <= chip.cluster.l1.banks) continue;
      const auto& l1_words = settings[schema.find(section_of(side, kernel) + ".l1_words")];
      throw InputError(fmt::format("{}, but {}: expected no more words per cycle than banks",
                                   state(*l1_words),
                                   state(*settings[schema.find("cluster.l1.banks")])));
    }
  }
}

}  // namespace leviosim::platform
