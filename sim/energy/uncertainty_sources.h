// What the energy figures of a chip may be wrong about. Numbers that share a source err together;
// different sources have nothing to do with each other. Estimates follow from this.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "sim/chip/energy_config.h"

namespace leviosim::sim {

struct UncertaintySource {
  std::string_view description;
  /// Copies the numbers that the source is about.
  void (*copy)(const EnergyConfig& from, EnergyConfig& to);
};

inline constexpr std::array kUncertaintySources{
    UncertaintySource{
        "energies of cores, L1, DMA and cluster: one table, of which voltage and clock",
        [](const EnergyConfig& from, EnergyConfig& to) {
          const Joules f32_operation = to.core.f32_operation;
          const double idle_clock = to.cluster.idle_clock;
          to.core = from.core;
          to.l1 = from.l1;
          to.dma = from.dma;
          to.cluster = from.cluster;
          to.core.f32_operation = f32_operation;
          to.cluster.idle_clock = idle_clock;
        }},
    UncertaintySource{"energy of a floating-point operation",
                      [](const EnergyConfig& from, EnergyConfig& to) {
                        to.core.f32_operation = from.core.f32_operation;
                      }},
    UncertaintySource{"energy of an access to L2",
                      [](const EnergyConfig& from, EnergyConfig& to) { to.l2 = from.l2; }},
    UncertaintySource{
        "energy of a clock cycle of the rest of the chip",
        [](const EnergyConfig& from, EnergyConfig& to) { to.soc.cycle = from.soc.cycle; }},
    UncertaintySource{"static power of the rest of the chip",
                      [](const EnergyConfig& from, EnergyConfig& to) {
                        to.soc.static_power = from.soc.static_power;
                      }},
    UncertaintySource{"whether the clock of an idle cluster keeps running",
                      [](const EnergyConfig& from, EnergyConfig& to) {
                        to.cluster.idle_clock = from.cluster.idle_clock;
                      }},
    UncertaintySource{"leakage of gates and memories",
                      [](const EnergyConfig& from, EnergyConfig& to) {
                        const EnergyConfig::BySize clock = to.by_size;
                        to.by_size = from.by_size;
                        to.by_size.gate_cycle = clock.gate_cycle;
                        to.by_size.gated = clock.gated;
                        to.by_size.bank_cycle = clock.bank_cycle;
                        to.by_size.stalled_cycle = clock.stalled_cycle;
                      }},
    UncertaintySource{"clock of gates and memories that do nothing",
                      [](const EnergyConfig& from, EnergyConfig& to) {
                        to.by_size.gate_cycle = from.by_size.gate_cycle;
                        to.by_size.gated = from.by_size.gated;
                        to.by_size.bank_cycle = from.by_size.bank_cycle;
                        to.by_size.stalled_cycle = from.by_size.stalled_cycle;
                      }},
    UncertaintySource{"energy of accelerators",
                      [](const EnergyConfig& from, EnergyConfig& to) {
                        to.cluster_accelerators = from.cluster_accelerators;
                        to.controller_accelerators = from.controller_accelerators;
                      }},
    UncertaintySource{
        "energy of external memory",
        [](const EnergyConfig& from, EnergyConfig& to) { to.external = from.external; }},
};

inline constexpr std::size_t kUncertaintySourceCount = kUncertaintySources.size();

}  // namespace leviosim::sim
