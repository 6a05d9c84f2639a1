// A chip whose energy figures are round, so that tests can state closed formulas: energies at 1 V,
// running at 1 V and 100 MHz.
#pragma once

#include "sim/energy/model.h"
#include "tests/sim/chip_test_config.h"

namespace leviosim::sim {

inline EnergyConfig round_energies() {
  EnergyConfig e;
  e.voltage = Volts(1);
  e.core = {Joules(5e-12), Joules(4e-12), Watts(40e-6), Watts(2e-6)};
  e.l1 = {Joules(2e-12), Watts(5e-6)};
  e.dma = {Joules(0.8e-12), Joules(0.4e-12), Watts(10e-6)};
  e.cluster = {Joules(12e-12), Watts(1e-3), 0.5};
  e.l2 = {Joules(10e-12)};
  e.soc = {Joules(20e-12), Watts(3e-3)};
  return e;
}

inline ChipConfig energy_chip() {
  ChipConfig chip = test_chip();
  chip.cluster.clock = chip.controller.clock = Hertz(100'000'000);
  chip.supply = {
      Volts(1), Volts(0.05), {Volts(0.65), Hertz(240'000'000)}, {Volts(1.25), Hertz(400'000'000)}};
  chip.energy = {round_energies(), round_energies(), round_energies()};
  return chip;
}

}  // namespace leviosim::sim
