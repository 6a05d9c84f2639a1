#include "sim/energy/model.h"

#include "sim/base/check.h"

namespace leviosim::sim {
namespace {

using Energies = std::array<Joules, kDomainCount>;

/// With one set of numbers.
class Model {
 public:
  Model(const EnergyConfig& config, Volts voltage, int l1_banks)
      : config_(config),
        scale_(voltage.count() / config.voltage.count()),
        l1_banks_(static_cast<double>(l1_banks)) {}

  Energies energies(const Activity& a) const {
    const auto& c = config_;
    // The domains do not have clocks of their own: the cluster's runs through all of its parts.
    const double clocked = a.cluster_cycles + c.cluster.idle_clock * a.idle_cluster_cycles;
    Energies e;
    e[index(Domain::Cores)] = events(a.instructions, c.core.instruction) +
                              flow(c.core.leakage, a.cores_working) +
                              flow(c.core.gated_leakage, a.cores_gated);
    e[index(Domain::Fpu)] = events(a.f32_operations, c.core.f32_operation);
    e[index(Domain::L1)] =
        events(a.l1_accesses, c.l1.access) + flow(c.l1.bank_leakage * l1_banks_, a.time);
    e[index(Domain::Dma)] = events(a.transfer_cycles, c.dma.transfer_cycle) +
                            events(clocked, c.dma.cycle) + flow(c.dma.leakage, a.time);
    e[index(Domain::Cluster)] = events(clocked, c.cluster.cycle) + flow(c.cluster.leakage, a.time);
    for (std::size_t k = 0; k < work::kOffloadKindCount; ++k) {
      e[index(Domain::Cluster)] += events(a.cluster_items[k], c.cluster_accelerators[k]);
      e[index(Domain::Soc)] += events(a.controller_items[k], c.controller_accelerators[k]);
    }
    e[index(Domain::Controller)] =
        events(a.controller_instructions, c.core.instruction) +
        events(a.controller_f32_operations, c.core.f32_operation) +
        flow(c.core.gated_leakage, a.time) +
        flow(c.core.leakage - c.core.gated_leakage, a.controller_working);
    e[index(Domain::L2)] = events(a.l2_accesses, c.l2.access);
    e[index(Domain::Soc)] += events(a.soc_cycles, c.soc.cycle) + flow(c.soc.static_power, a.time);
    return e;
  }

 private:
  Joules events(double count, Joules each) const { return each * (count * scale_ * scale_); }
  Joules flow(Watts power, Seconds time) const { return power * scale_ * time; }

  const EnergyConfig& config_;
  double scale_;  ///< supply voltage over that for which the numbers hold
  double l1_banks_;
};

}  // namespace

Estimate<Joules> DomainEnergies::total() const {
  Estimate<Joules> sum;
  for (const Estimate<Joules>& energy : energies_) sum += energy;
  return sum;
}

DomainEnergies& DomainEnergies::operator+=(const DomainEnergies& o) {
  for (std::size_t i = 0; i < kDomainCount; ++i) energies_[i] += o.energies_[i];
  return *this;
}

bool knows_energy(const ChipConfig& chip) { return chip.supply.voltage > Volts(0); }

DomainEnergies energy_of(const Activity& activity, const ChipConfig& chip) {
  check(knows_energy(chip), "energy of a chip without energy figures");
  const auto with = [&](const EnergyConfig& config) {
    return Model(config, chip.supply.voltage, chip.cluster.l1.banks).energies(activity);
  };
  const Energies value = with(chip.energy.value);
  DomainEnergies result;
  for (const DomainInfo& info : kDomains) result[info.domain].value = value[index(info.domain)];
  for (std::size_t source = 0; source < kUncertaintySourceCount; ++source) {
    EnergyConfig low = chip.energy.value;
    EnergyConfig high = chip.energy.value;
    kUncertaintySources[source].copy(chip.energy.low, low);
    kUncertaintySources[source].copy(chip.energy.high, high);
    const Energies least = with(low);
    const Energies most = with(high);
    for (const DomainInfo& info : kDomains) {
      const std::size_t i = index(info.domain);
      result[info.domain].down[source] = value[i] - least[i];
      result[info.domain].up[source] = most[i] - value[i];
    }
  }
  return result;
}

}  // namespace leviosim::sim
