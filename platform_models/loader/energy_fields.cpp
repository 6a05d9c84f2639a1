#include "platform_models/loader/energy_fields.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "platform_models/loader/member_values.h"

namespace leviosim::platform {
namespace {

using sim::ChipConfig;
using sim::EnergyConfig;

// Limits that keep typing errors out.
constexpr double kMaxEvent = 1e-6;  // joules
constexpr double kMaxPower = 10;    // watts
constexpr double kMaxArea = 1e9;    // square micrometres
constexpr double kMaxPorts = 1024;
constexpr double kMaxBytes = 1e12;
constexpr double kMinVoltage = 0.1;  // volts
constexpr double kMaxVoltage = 10;

Field row(const char* path, const Dimension& dimension, double min, double max,
          const char* description) {
  Field field;
  field.path = path;
  field.record = path;
  field.name = "value";
  field.dimension = &dimension;
  field.min = min;
  field.max = max;
  field.required = false;
  field.description = description;
  return field;
}

Field voltage(const char* path, const char* description) {
  return row(path, kVoltage, kMinVoltage, kMaxVoltage, description);
}
Field clock(const char* path, const char* description) {
  return row(path, kFrequency, kMinClock, kMaxClock, description);
}
Field event(const char* path, const char* description) {
  return row(path, kEnergy, 0, kMaxEvent, description);
}
Field power(const char* path, const char* description) {
  return row(path, kPower, 0, kMaxPower, description);
}

/// @param member  returns a reference to the field's place in a SupplyConfig, const or not
template <class Member>
Field of_supply(Field field, Member member) {
  field.set = [member](ChipConfig& chip, double value) { put(member(chip.supply), value); };
  field.get = [member](const ChipConfig& chip) { return as_number(member(chip.supply)); };
  return field;
}

/// A number with a band.
/// @param Range   the member of ChipConfig that has the number and its ends
/// @param member  as above, in that
template <auto Range, class Member>
Field banded(Field field, Member member) {
  field.set = [member](ChipConfig& chip, double value) {
    auto& range = chip.*Range;
    for (auto* numbers : {&range.value, &range.low, &range.high}) put(member(*numbers), value);
  };
  field.get = [member](const ChipConfig& chip) { return as_number(member((chip.*Range).value)); };
  field.set_band = [member](ChipConfig& chip, double low, double high) {
    put(member((chip.*Range).low), low);
    put(member((chip.*Range).high), high);
  };
  return field;
}
template <class Member>
Field of_energy(Field field, Member member) {
  return banded<&ChipConfig::energy>(std::move(field), member);
}
template <class Member>
Field of_area(const char* path, const Dimension& dimension, double max, const char* description,
              Member member) {
  return banded<&ChipConfig::area>(row(path, dimension, 0, max, description), member);
}

std::vector<Field> supply_fields() {
  return {
      of_supply(
          voltage("supply.voltage", "supply of cluster, controller and memories"),
          [](auto& s) -> auto& { return s.voltage; }),
      of_supply(
          row("supply.step", kVoltage, 1e-3, kMaxVoltage,
              "granularity of the supply, counted from its lowest voltage"),
          [](auto& s) -> auto& { return s.step; }),
      of_supply(
          voltage("supply.lowest.voltage", "lowest voltage of the supply"),
          [](auto& s) -> auto& { return s.lowest.voltage; }),
      of_supply(
          clock("supply.lowest.clock", "highest clock at the lowest voltage"),
          [](auto& s) -> auto& { return s.lowest.clock; }),
      of_supply(
          voltage("supply.highest.voltage", "highest voltage of the supply"),
          [](auto& s) -> auto& { return s.highest.voltage; }),
      of_supply(
          clock("supply.highest.clock", "highest clock at the highest voltage"),
          [](auto& s) -> auto& { return s.highest.clock; }),
  };
}

std::vector<Field> cluster_energy_fields() {
  return {
      of_energy(
          event("energy.core.instruction", "an instruction, with its fetch"),
          [](auto& e) -> auto& { return e.core.instruction; }),
      of_energy(
          event("energy.core.f32_operation",
                "an operation of a floating-point unit, besides its instruction"),
          [](auto& e) -> auto& { return e.core.f32_operation; }),
      of_energy(
          power("energy.core.leakage", "leakage of a core that works"),
          [](auto& e) -> auto& { return e.core.leakage; }),
      of_energy(
          power("energy.core.gated_leakage", "leakage of a core that waits, clock-gated"),
          [](auto& e) -> auto& { return e.core.gated_leakage; }),
      of_energy(
          event("energy.l1.access", "an access to L1 of up to 32 bits"),
          [](auto& e) -> auto& { return e.l1.access; }),
      of_energy(
          power("energy.l1.bank_leakage", "leakage of a bank of L1"),
          [](auto& e) -> auto& { return e.l1.bank_leakage; }),
      of_energy(
          event("energy.dma.transfer_cycle",
                "DMA, in a cycle (of the controller's clock) of a transfer"),
          [](auto& e) -> auto& { return e.dma.transfer_cycle; }),
      of_energy(
          event("energy.dma.cycle", "DMA, in a cycle of the cluster's clock"),
          [](auto& e) -> auto& { return e.dma.cycle; }),
      of_energy(
          power("energy.dma.leakage", "leakage of the DMA"),
          [](auto& e) -> auto& { return e.dma.leakage; }),
      of_energy(
          event("energy.cluster.cycle", "rest of the cluster, in a cycle of its clock"),
          [](auto& e) -> auto& { return e.cluster.cycle; }),
      of_energy(
          power("energy.cluster.leakage", "leakage of the rest of the cluster"),
          [](auto& e) -> auto& { return e.cluster.leakage; }),
      of_energy(
          row("energy.cluster.idle_clock", kRatio, 0, 1,
              "share of the clock cycles that go on while the cluster has no work"),
          [](auto& e) -> auto& { return e.cluster.idle_clock; }),
  };
}

std::vector<Field> soc_energy_fields() {
  return {
      of_energy(
          event("energy.l2.access", "an access to L2 of up to 32 bits"),
          [](auto& e) -> auto& { return e.l2.access; }),
      of_energy(
          event("energy.soc.cycle", "rest of the chip, in a cycle of the controller's clock"),
          [](auto& e) -> auto& { return e.soc.cycle; }),
      of_energy(
          power("energy.soc.static", "rest of the chip, whatever its clock"),
          [](auto& e) -> auto& { return e.soc.static_power; }),
  };
}

std::vector<Field> energy_by_size_fields() {
  return {
      of_energy(
          event("energy.by_size.gate_cycle", "a thousand gates, in a cycle of their clock"),
          [](auto& e) -> auto& { return e.by_size.gate_cycle; }),
      of_energy(
          row("energy.by_size.gated", kRatio, 0, 1, "share of it while a core's clock is stopped"),
          [](auto& e) -> auto& { return e.by_size.gated; }),
      of_energy(
          event("energy.by_size.bank_cycle", "a bank of L1 or block of L2, in a cycle"),
          [](auto& e) -> auto& { return e.by_size.bank_cycle; }),
      of_energy(
          event("energy.by_size.stalled_cycle", "a core that waits with its clock on, in a cycle"),
          [](auto& e) -> auto& { return e.by_size.stalled_cycle; }),
      of_energy(
          power("energy.by_size.gate_leakage", "leakage of a thousand gates"),
          [](auto& e) -> auto& { return e.by_size.gate_leakage; }),
      of_energy(
          power("energy.by_size.l1_leakage", "leakage of a KiB of L1"),
          [](auto& e) -> auto& { return e.by_size.l1_leakage; }),
      of_energy(
          power("energy.by_size.l2_leakage", "leakage of a KiB of L2"),
          [](auto& e) -> auto& { return e.by_size.l2_leakage; }),
      of_energy(
          row("energy.by_size.leakage_exponent", kRatio, 0, 10,
              "power of the voltage with which leakage grows"),
          [](auto& e) -> auto& { return e.by_size.leakage_exponent; }),
  };
}

std::vector<Field> technology_fields() {
  return {
      of_area(
          "area.gate", kArea, kMaxArea, "a thousand gate equivalents, placed",
          [](auto& a) -> auto& { return a.gate; }),
      of_area(
          "area.sram_cut", kArea, kMaxArea, "a memory block, whatever its size",
          [](auto& a) -> auto& { return a.sram_cut; }),
      of_area(
          "area.sram_bit", kArea, kMaxArea, "and each of its bits",
          [](auto& a) -> auto& { return a.sram_bit; }),
      of_area(
          "area.latch_bit", kArea, kMaxArea, "a bit of a memory of latches",
          [](auto& a) -> auto& { return a.latch_bit; }),
      of_area(
          "area.latch_limit", kSize, kMaxBytes,
          "largest private instruction cache that is made of latches",
          [](auto& a) -> auto& { return a.latch_limit; }),
      of_area(
          "area.l2_cut", kSize, kMaxBytes, "size of a memory block of L2",
          [](auto& a) -> auto& { return a.l2_cut; }),
  };
}

std::vector<Field> logic_fields() {
  return {
      of_area(
          "area.core", kGates, kMaxGates, "a core without floating-point unit",
          [](auto& a) -> auto& { return a.core; }),
      of_area(
          "area.fpu", kGates, kMaxGates, "a floating-point unit without divider",
          [](auto& a) -> auto& { return a.fpu; }),
      of_area(
          "area.divider", kGates, kMaxGates, "a unit for quotients and square roots",
          [](auto& a) -> auto& { return a.divider; }),
      of_area(
          "area.fpu_crosspoint", kGates, kMaxGates,
          "network of shared units, for a core and a unit that it may use",
          [](auto& a) -> auto& { return a.fpu_crosspoint; }),
      of_area(
          "area.memory_crosspoint", kGates, kMaxGates,
          "networks of L1 and L2, for a master and a bank",
          [](auto& a) -> auto& { return a.memory_crosspoint; }),
      of_area(
          "area.l1_masters", kUnits, kMaxPorts, "masters of L1 besides the cores",
          [](auto& a) -> auto& { return a.l1_masters; }),
      of_area(
          "area.l2_masters", kUnits, kMaxPorts, "masters of L2",
          [](auto& a) -> auto& { return a.l2_masters; }),
      of_area(
          "area.private_cache", kGates, kMaxGates, "control of a private instruction cache",
          [](auto& a) -> auto& { return a.private_cache; }),
      of_area(
          "area.shared_cache", kGates, kMaxGates, "control of the shared instruction cache",
          [](auto& a) -> auto& { return a.shared_cache; }),
      of_area(
          "area.dma", kGates, kMaxGates, "the DMA of the cluster",
          [](auto& a) -> auto& { return a.dma; }),
      of_area(
          "area.event_unit", kGates, kMaxGates, "the event unit, for each core",
          [](auto& a) -> auto& { return a.event_unit; }),
      of_area(
          "area.cluster_rest", kGates, kMaxGates, "buses, clock crossing, control of the cluster",
          [](auto& a) -> auto& { return a.cluster_rest; }),
      of_area(
          "area.not_simulated", kGates, kMaxGates,
          "accelerators of the cluster that are not simulated",
          [](auto& a) -> auto& { return a.not_simulated; }),
      of_area(
          "area.controller_rest", kGates, kMaxGates,
          "what the controller has besides core, floating-point unit and divider",
          [](auto& a) -> auto& { return a.controller_rest; }),
      of_area(
          "area.soc_rest", kGates, kMaxGates, "peripherals and control of the chip",
          [](auto& a) -> auto& { return a.soc_rest; }),
  };
}

/// Fixed amounts, in place of which a platform with areas has those of energy.by_size.
constexpr std::array<std::string_view, 8> kFixed{
    "energy.core.leakage",    "energy.core.gated_leakage", "energy.l1.bank_leakage",
    "energy.dma.cycle",       "energy.dma.leakage",        "energy.cluster.cycle",
    "energy.cluster.leakage", "energy.soc.cycle"};

}  // namespace

std::vector<Field> area_fields() {
  std::vector<Field> fields = technology_fields();
  for (Field& field : logic_fields()) fields.push_back(std::move(field));
  return fields;
}

std::vector<Field> energy_fields() {
  std::vector<Field> fields = supply_fields();
  fields.push_back(of_energy(
      voltage("energy.voltage", "supply for which the section holds"),
      [](auto& e) -> auto& { return e.voltage; }));
  for (std::vector<Field>& part :
       std::array{cluster_energy_fields(), soc_energy_fields(), energy_by_size_fields()})
    for (Field& field : part) fields.push_back(std::move(field));
  return fields;
}

EnergyGroup energy_group_of(const Field& field) {
  const auto begins = [&](const char* with) { return field.path.rfind(with, 0) == 0; };
  if (begins("area.")) return EnergyGroup::Area;
  if (begins("energy.by_size.")) return EnergyGroup::BySize;
  if (std::find(kFixed.begin(), kFixed.end(), field.path) != kFixed.end())
    return EnergyGroup::Fixed;
  return begins("supply.") || begins("energy.") ? EnergyGroup::Always : EnergyGroup::None;
}

}  // namespace leviosim::platform
