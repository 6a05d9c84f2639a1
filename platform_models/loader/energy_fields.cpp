#include "platform_models/loader/energy_fields.h"

#include <utility>

#include "platform_models/loader/member_values.h"

namespace leviosim::platform {
namespace {

using sim::ChipConfig;
using sim::EnergyConfig;

// Limits that keep typing errors out.
constexpr double kMaxEvent = 1e-6;   // joules
constexpr double kMaxPower = 10;     // watts
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

/// A number with a band. @param member  as above, in an EnergyConfig
template <class Member>
Field of_energy(Field field, Member member) {
  field.set = [member](ChipConfig& chip, double value) {
    for (EnergyConfig* config : {&chip.energy.value, &chip.energy.low, &chip.energy.high})
      put(member(*config), value);
  };
  field.get = [member](const ChipConfig& chip) { return as_number(member(chip.energy.value)); };
  field.set_band = [member](ChipConfig& chip, double low, double high) {
    put(member(chip.energy.low), low);
    put(member(chip.energy.high), high);
  };
  return field;
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

}  // namespace

std::vector<Field> energy_fields() {
  std::vector<Field> fields = supply_fields();
  fields.push_back(of_energy(
      voltage("energy.voltage", "supply for which the section holds"),
      [](auto& e) -> auto& { return e.voltage; }));
  for (std::vector<Field>& part : std::array{cluster_energy_fields(), soc_energy_fields()})
    for (Field& field : part) fields.push_back(std::move(field));
  return fields;
}

bool is_about_energy(const Field& field) {
  return field.path.rfind("supply.", 0) == 0 || field.path.rfind("energy.", 0) == 0;
}

}  // namespace leviosim::platform
