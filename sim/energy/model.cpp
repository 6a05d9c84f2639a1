#include "sim/energy/model.h"

#include <algorithm>
#include <cmath>

#include "sim/base/check.h"
#include "sim/energy/area.h"

namespace leviosim::sim {
namespace {

using Energies = std::array<Joules, kDomainCount>;

/// With one set of numbers.
class Model {
 public:
  Model(const EnergyConfig& config, const ChipConfig& chip, const GatesByDomain& gates)
      : config_(config),
        chip_(chip),
        gates_(gates),
        scale_(chip.supply.voltage.count() / config.voltage.count()) {}

  Energies energies(const Activity& a) const {
    Energies e = fixed(a);
    add_by_size(a, e);
    return e;
  }

 private:
  /// Of events, and of clock and leakage of parts whose size nobody asks for.
  Energies fixed(const Activity& a) const {
    const auto& c = config_;
    // The domains do not have clocks of their own: the cluster's runs through all of its parts.
    const double clocked = a.cluster_cycles + c.cluster.idle_clock * a.idle_cluster_cycles;
    Energies e;
    e[index(Domain::Cores)] = events(a.instructions, c.core.instruction) +
                              flow(c.core.leakage, a.cores_working) +
                              flow(c.core.gated_leakage, a.cores_gated);
    e[index(Domain::Fpu)] = events(a.f32_operations, c.core.f32_operation);
    e[index(Domain::L1)] =
        events(a.l1_accesses, c.l1.access) + flow(c.l1.bank_leakage * l1_banks(), a.time);
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
    e[index(Domain::External)] =
        c.external.byte * a.external_bytes + c.external.static_power * a.external_on;
    return e;
  }

  void add_by_size(const Activity& a, Energies& e) const {
    const EnergyConfig::BySize& c = config_.by_size;
    const double clocked = a.cluster_cycles + config_.cluster.idle_clock * a.idle_cluster_cycles;
    const auto gates = [&](Domain d) { return gates_[index(d)].count(); };
    const auto add = [&](Domain d, double cycles) {
      e[index(d)] +=
          events(cycles * gates(d), c.gate_cycle) + leak(c.gate_leakage * gates(d), a.time);
    };
    const double cluster_clock = static_cast<double>(chip_.cluster.clock.count());
    const double controller_clock = static_cast<double>(chip_.controller.clock.count());
    // A core's share of its domain, in the cycles in which its clock is stopped.
    const double gated = c.gated * a.cores_gated.count() * cluster_clock;
    add(Domain::Cores, gated / static_cast<double>(chip_.cluster.workers + 1));
    for (const Domain d : {Domain::Fpu, Domain::L1, Domain::Dma, Domain::Cluster}) add(d, clocked);
    for (const Domain d : {Domain::L2, Domain::Soc}) add(d, a.soc_cycles);
    add(Domain::Controller, c.gated * a.soc_cycles);
    e[index(Domain::Cores)] += stalls(a.cores_working.count() * cluster_clock, a.instructions);
    e[index(Domain::Controller)] +=
        stalls(a.controller_working.count() * controller_clock, a.controller_instructions);
    e[index(Domain::L1)] += events(clocked * l1_banks(), c.bank_cycle) +
                            leak(c.l1_leakage * kibibytes(chip_.cluster.l1.size), a.time);
    e[index(Domain::L2)] += events(a.soc_cycles * l2_cuts(chip_), c.bank_cycle) +
                            leak(c.l2_leakage * kibibytes(chip_.l2.size), a.time);
  }

  static double kibibytes(Bytes size) { return static_cast<double>(size.count()) / 1024; }
  double l1_banks() const { return chip_.cluster.l1.banks; }
  Joules stalls(double cycles, double instructions) const {
    return events(std::max(0.0, cycles - instructions), config_.by_size.stalled_cycle);
  }
  Joules events(double count, Joules each) const { return each * (count * scale_ * scale_); }
  Joules flow(Watts power, Seconds time) const { return power * scale_ * time; }
  Joules leak(Watts power, Seconds time) const {
    return power * std::pow(scale_, config_.by_size.leakage_exponent) * time;
  }

  const EnergyConfig& config_;
  const ChipConfig& chip_;
  const GatesByDomain& gates_;
  double scale_;  ///< supply voltage over that for which the numbers hold
};

}  // namespace

Estimate<Joules> DomainEnergies::total() const {
  Estimate<Joules> sum;
  for (const Estimate<Joules>& energy : energies_) sum += energy;
  return sum;
}

std::span<const DomainInfo> domains_of(const DomainEnergies& energies) {
  const bool outside = energies[Domain::External].high() > Joules(0);
  return std::span(kDomains).first(kDomainCount - (outside ? 0 : 1));
}

DomainEnergies& DomainEnergies::operator+=(const DomainEnergies& o) {
  for (std::size_t i = 0; i < kDomainCount; ++i) energies_[i] += o.energies_[i];
  return *this;
}

bool knows_energy(const ChipConfig& chip) { return chip.supply.voltage > Volts(0); }

DomainEnergies energy_of(const Activity& activity, const ChipConfig& chip) {
  check(knows_energy(chip), "energy of a chip without energy figures");
  const GatesByDomain gates = gates_by_domain(chip);
  const auto with = [&](const EnergyConfig& config) {
    return Model(config, chip, gates).energies(activity);
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
