#include "platform_models/loader/energy_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "platform_models/loader/member_values.h"

namespace leviosim::platform {
namespace {

using sim::ChipConfig;
using E = sim::EnergyConfig;
using A = sim::AreaConfig;
using S = sim::SupplyConfig;

// Limits that keep typing errors out.
constexpr double kMaxEvent = 1e-6;  // joules
constexpr double kMaxPower = 10;    // watts
constexpr double kMaxArea = 1e9;    // square micrometres
constexpr double kMaxPorts = 1024;
constexpr double kMaxBytes = 1e12;
constexpr double kMinVoltage = 0.1;  // volts
constexpr double kMaxVoltage = 10;

Field row(const char* path, const Dimension& dimension, double min, double max,
          std::string description) {
  Field field;
  field.path = path;
  field.record = path;
  field.name = "value";
  field.dimension = &dimension;
  field.min = min;
  field.max = max;
  field.required = false;
  field.description = std::move(description);
  return field;
}

Field voltage(const char* path, const char* description) {
  return row(path, kVoltage, kMinVoltage, kMaxVoltage, description);
}
Field clock(const char* path, const char* description) {
  return row(path, kFrequency, kMinClock, kMaxClock, description);
}
/// @param what  has this energy
Field event(const char* path, std::string_view what) {
  return row(path, kEnergy, 0, kMaxEvent, fmt::format("energy of {}", what));
}
Field power(const char* path, const char* description) {
  return row(path, kPower, 0, kMaxPower, description);
}

/// The member of a record, or of a record in it, and so on. @param path  pointers to members
template <class Record, class... Path>
auto& at(Record& record, Path... path) {
  return (record.*....*path);
}

template <class... Path>
Field of_supply(Field field, Path... path) {
  field.set = [=](ChipConfig& chip, double value) { put(at(chip.supply, path...), value); };
  field.get = [=](const ChipConfig& chip) { return as_number(at(chip.supply, path...)); };
  return field;
}

/// A number with a band. @param Range  the member of ChipConfig that has the number and its ends
template <auto Range, class... Path>
Field banded(Field field, Path... path) {
  field.set = [=](ChipConfig& chip, double value) {
    auto& range = chip.*Range;
    for (auto* numbers : {&range.value, &range.low, &range.high}) put(at(*numbers, path...), value);
  };
  field.get = [=](const ChipConfig& chip) { return as_number(at((chip.*Range).value, path...)); };
  field.set_band = [=](ChipConfig& chip, double low, double high) {
    put(at((chip.*Range).low, path...), low);
    put(at((chip.*Range).high, path...), high);
  };
  return field;
}
template <class... Path>
Field of_energy(Field field, Path... path) {
  return banded<&ChipConfig::energy>(std::move(field), path...);
}
template <class Member>
Field of_area(const char* path, const Dimension& dimension, double max, std::string description,
              Member member) {
  return banded<&ChipConfig::area>(row(path, dimension, 0, max, std::move(description)), member);
}
/// @param what  has this area, in thousands of gate equivalents
template <class Member>
Field gates(const char* path, std::string_view what, Member member) {
  return of_area(path, kGates, kMaxGates, fmt::format("area of {}", what), member);
}
/// @param what  has this area on silicon
template <class Member>
Field silicon(const char* path, std::string_view what, Member member) {
  return of_area(path, kArea, kMaxArea, fmt::format("area of {}", what), member);
}

std::vector<Field> supply_fields() {
  return {
      of_supply(voltage("supply.voltage", "supply voltage of cluster, controller and memories"),
                &S::voltage),
      of_supply(row("supply.step", kVoltage, 1e-3, kMaxVoltage,
                    "step of the supply voltage, counted from its lowest one"),
                &S::step),
      of_supply(voltage("supply.lowest.voltage", "lowest voltage of the supply"), &S::lowest,
                &sim::OperatingPoint::voltage),
      of_supply(clock("supply.lowest.clock", "highest clock at the lowest voltage"), &S::lowest,
                &sim::OperatingPoint::clock),
      of_supply(voltage("supply.highest.voltage", "highest voltage of the supply"), &S::highest,
                &sim::OperatingPoint::voltage),
      of_supply(clock("supply.highest.clock", "highest clock at the highest voltage"), &S::highest,
                &sim::OperatingPoint::clock),
  };
}

std::vector<Field> cluster_energy_fields() {
  return {
      of_energy(event("energy.core.instruction", "an instruction with its fetch"), &E::core,
                &E::Core::instruction),
      of_energy(event("energy.core.f32_operation",
                      "an operation of a floating-point unit, besides its instruction"),
                &E::core, &E::Core::f32_operation),
      of_energy(power("energy.core.leakage", "leakage of a core that works"), &E::core,
                &E::Core::leakage),
      of_energy(power("energy.core.gated_leakage", "leakage of a core that waits, clock-gated"),
                &E::core, &E::Core::gated_leakage),
      of_energy(event("energy.l1.access", "an access to L1 of up to 32 bits"), &E::l1,
                &E::L1::access),
      of_energy(power("energy.l1.bank_leakage", "leakage of a bank of L1"), &E::l1,
                &E::L1::bank_leakage),
      of_energy(event("energy.dma.transfer_cycle",
                      "the DMA in a cycle of the controller's clock during a transfer"),
                &E::dma, &E::Dma::transfer_cycle),
      of_energy(event("energy.dma.cycle", "the DMA in a cycle of the cluster's clock"), &E::dma,
                &E::Dma::cycle),
      of_energy(power("energy.dma.leakage", "leakage of the DMA"), &E::dma, &E::Dma::leakage),
      of_energy(event("energy.cluster.cycle", "the rest of the cluster in a cycle of its clock"),
                &E::cluster, &E::Cluster::cycle),
      of_energy(power("energy.cluster.leakage", "leakage of the rest of the cluster"), &E::cluster,
                &E::Cluster::leakage),
      of_energy(row("energy.cluster.idle_clock", kRatio, 0, 1,
                    "share of the clock cycles that go on while the cluster has no work"),
                &E::cluster, &E::Cluster::idle_clock),
  };
}

std::vector<Field> soc_energy_fields() {
  return {
      of_energy(event("energy.l2.access", "an access to L2 of up to 32 bits"), &E::l2,
                &E::L2::access),
      of_energy(
          event("energy.soc.cycle", "the rest of the chip in a cycle of the controller's clock"),
          &E::soc, &E::Soc::cycle),
      of_energy(power("energy.soc.static", "power of the rest of the chip at any clock"), &E::soc,
                &E::Soc::static_power),
      of_energy(event("energy.external.byte", "a byte from or to external memory, with its pins"),
                &E::external, &E::External::byte),
      of_energy(power("energy.external.static",
                      "external memory that keeps something: refresh and standby"),
                &E::external, &E::External::static_power),
  };
}

std::vector<Field> energy_by_size_fields() {
  return {
      of_energy(event("energy.by_size.gate_cycle", "a thousand gates in a cycle of their clock"),
                &E::by_size, &E::BySize::gate_cycle),
      of_energy(row("energy.by_size.gated", kRatio, 0, 1,
                    "share of a core's gate_cycle energy while its clock is stopped"),
                &E::by_size, &E::BySize::gated),
      of_energy(event("energy.by_size.bank_cycle", "a bank of L1 or block of L2 in a cycle"),
                &E::by_size, &E::BySize::bank_cycle),
      of_energy(
          event("energy.by_size.stalled_cycle", "a core that waits with its clock on in a cycle"),
          &E::by_size, &E::BySize::stalled_cycle),
      of_energy(power("energy.by_size.gate_leakage", "leakage of a thousand gates"), &E::by_size,
                &E::BySize::gate_leakage),
      of_energy(power("energy.by_size.l1_leakage", "leakage of a KiB of L1"), &E::by_size,
                &E::BySize::l1_leakage),
      of_energy(power("energy.by_size.l2_leakage", "leakage of a KiB of L2"), &E::by_size,
                &E::BySize::l2_leakage),
      of_energy(row("energy.by_size.leakage_exponent", kRatio, 0, 10,
                    "exponent of the voltage in leakage"),
                &E::by_size, &E::BySize::leakage_exponent),
  };
}

std::vector<Field> technology_fields() {
  return {
      silicon("area.gate", "a thousand gate equivalents, placed", &A::gate),
      silicon("area.sram_cut", "a memory block, whatever its size", &A::sram_cut),
      silicon("area.sram_bit", "a bit of a memory block, in addition", &A::sram_bit),
      silicon("area.latch_bit", "a bit of a memory of latches", &A::latch_bit),
      of_area("area.l2_cut", kSize, kMaxBytes, "size of a memory block of L2", &A::l2_cut),
  };
}

std::vector<Field> logic_fields() {
  return {
      gates("area.core", "a core without extensions and floating-point unit", &A::core),
      gates("area.xpulp", "the Xpulp extensions of a core", &A::xpulp),
      gates("area.fpu", "a floating-point unit without divider", &A::fpu),
      gates("area.divider", "a unit for quotients and square roots", &A::divider),
      gates("area.fpu_crosspoint",
            "the network of shared units, for a core and a unit that it may use",
            &A::fpu_crosspoint),
      gates("area.memory_crosspoint", "the networks of L1 and L2, for a master and a bank",
            &A::memory_crosspoint),
      of_area("area.l1_masters", kUnits, kMaxPorts, "number of masters of L1 besides cores and DMA",
              &A::l1_masters),
      of_area("area.l2_masters", kUnits, kMaxPorts, "number of masters of L2", &A::l2_masters),
      gates("area.private_cache", "the control of a private instruction cache", &A::private_cache),
      gates("area.shared_cache", "the control of the shared instruction cache", &A::shared_cache),
      gates("area.cache_way",
            "comparison and choice for each way of a bank of an instruction cache", &A::cache_way),
      gates("area.refill_buffer",
            "a refill buffer, for each line that the shared instruction cache can await",
            &A::refill_buffer),
      gates("area.dma", "the control of the cluster's DMA", &A::dma),
      gates("area.dma_byte", "the DMA's data path, for each byte per cycle", &A::dma_byte),
      gates("area.dma_command", "the DMA's queue, for each transfer that may be under way",
            &A::dma_command),
      gates("area.int64_unit", "a unit for 64-bit integers", &A::int64_unit),
      gates("area.controller_bus_byte", "the controller's bus for code, for each byte per cycle",
            &A::controller_bus_byte),
      gates("area.event_unit", "the event unit, for each core", &A::event_unit),
      gates("area.cluster_bus_byte", "the bus from the cluster to L2, for each byte per cycle",
            &A::cluster_bus_byte),
      gates("area.cluster_rest", "the cluster's other buses, clock crossing and control",
            &A::cluster_rest),
      gates("area.not_simulated", "accelerators of the cluster that are not simulated",
            &A::not_simulated),
      gates("area.controller_rest", "the controller besides core, floating-point unit and divider",
            &A::controller_rest),
      gates("area.soc_rest", "peripherals and control of the chip", &A::soc_rest),
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
      voltage("energy.voltage", "supply voltage for which the section holds"), &E::voltage));
  for (std::vector<Field>& part :
       std::array{cluster_energy_fields(), soc_energy_fields(), energy_by_size_fields()})
    for (Field& field : part) fields.push_back(std::move(field));
  return fields;
}

EnergyGroup energy_group_of(const Field& field) {
  const auto begins = [&](const char* with) { return field.path.rfind(with, 0) == 0; };
  if (begins("area.")) return EnergyGroup::Area;
  if (!begins("supply.") && !begins("energy.")) return EnergyGroup::None;
  if (begins("energy.external.")) return EnergyGroup::None;  // not every chip has such a memory
  if (begins("energy.by_size.")) return EnergyGroup::BySize;
  const bool fixed = std::find(kFixed.begin(), kFixed.end(), field.path) != kFixed.end();
  return fixed ? EnergyGroup::Fixed : EnergyGroup::Always;
}

}  // namespace leviosim::platform
