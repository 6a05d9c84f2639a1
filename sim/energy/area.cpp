#include "sim/energy/area.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "sim/base/check.h"

namespace leviosim::sim {
namespace {

constexpr double kBitsPerByte = 8;
constexpr double kAddressBits = 32;
constexpr double kValidBit = 1;
constexpr double kLineAddressBits = 28;
/// Of a crosspoint of the network of L1: data both ways, address, byte enables, control.
constexpr double kMemoryWires = 32 + 32 + 20;
/// Cycles that a shared instruction cache takes longer than a private one: its network, and itself
/// (FACTS.md#instruction-caches).
constexpr double kSharedHit = 2;
constexpr double kPortBytes = 4;

double bits_of(Bytes size) { return static_cast<double>(size.count()) * kBitsPerByte; }

/// Lists what a chip has with one set of numbers.
class Parts {
 public:
  Parts(const ChipConfig& chip, const AreaConfig& numbers)
      : chip_(chip), n_(numbers), cores_(chip.cluster.workers + 1) {}

  std::vector<AreaItem> list() {
    cores_and_units();
    memories_of_cluster();
    rest_of_cluster();
    accelerators("cluster accelerator", Domain::Cluster, chip_.cluster.accelerators,
                 n_.cluster_accelerators);
    controller_and_soc();
    accelerators("controller accelerator", Domain::Soc, chip_.controller.accelerators,
                 n_.controller_accelerators);
    return std::move(items_);
  }

 private:
  void add(std::string name, Domain domain, double count, KiloGates gates, SquareMicrometres area) {
    if (count > 0) items_.push_back({std::move(name), domain, count, gates, area, {}, {}});
  }
  void logic(std::string name, Domain domain, double count, KiloGates each) {
    add(std::move(name), domain, count, each * count, placed(each) * count);
  }
  /// A memory that is part of the logic, such as a cache.
  void memory(std::string name, Domain domain, double count, SquareMicrometres each) {
    add(std::move(name), domain, count, KiloGates(each.count() * count / n_.gate.count()),
        each * count);
  }
  void banks(std::string name, Domain domain, double count, Bytes each) {
    add(std::move(name), domain, count, {}, sram(bits_of(each)) * count);
  }

  KiloGates core(const CoreConfig& core) const {
    return core.code == work::CompiledFor::Rv32imfcXpulp ? n_.core + n_.xpulp : n_.core;
  }
  /// That come per cycle at most.
  static double bytes_of_code(const InstructionCacheConfig& cache) {
    return std::min(cache.refill_width, static_cast<double>(cache.line.count()));
  }
  SquareMicrometres placed(KiloGates gates) const { return n_.gate * gates.count(); }
  SquareMicrometres sram(double bits) const { return n_.sram_cut + n_.sram_bit * bits; }
  SquareMicrometres latches(double bits) const { return n_.latch_bit * bits; }

  /// Address bits that neither set nor byte give, and one that says whether the line is valid.
  static double tag_bits(Bytes size, const InstructionCacheConfig& cache) {
    const double lines = std::max(1.0, static_cast<double>(size.count() / cache.line.count()));
    const double way = static_cast<double>(size.count()) / cache.ways;
    return lines * (kAddressBits - std::log2(std::max(1.0, way)) + kValidBit);
  }

  void private_cache(std::string name, Domain domain, double count, Bytes size,
                     const InstructionCacheConfig& cache) {
    if (size == Bytes(0) || cache.line == Bytes(0)) return;
    memory(std::move(name), domain, count,
           smaller(bits_of(size)) + smaller(tag_bits(size, cache)) +
               placed(n_.private_cache + n_.cache_way * cache.ways));
  }
  SquareMicrometres smaller(double bits) const { return std::min(sram(bits), latches(bits)); }

  void shared_cache(const InstructionCacheConfig& cache) {
    if (cache.shared == Bytes(0) || cache.line == Bytes(0)) return;
    const double banks = cache.shared_banks;
    memory("shared instruction cache", Domain::Cluster, copies_of(cache),
           sram(bits_of(cache.shared) / banks) * banks + smaller(tag_bits(cache.shared, cache)) +
               placed(n_.shared_cache + n_.cache_way * (cache.ways * banks) +
                      n_.refill_buffer * cache.refills));
    const double wires = bits_of(cache.line) + kLineAddressBits;
    logic("network of this cache", Domain::Cluster, cores_ * banks,
          n_.memory_crosspoint * (wires / kMemoryWires));
  }
  /// Without a wait it is as near to each core as a private cache, so each has one of this size.
  double copies_of(const InstructionCacheConfig& cache) const {
    const double in_no_time = std::clamp(1 - cache.shared_hit / kSharedHit, 0.0, 1.0);
    return 1 + (cores_ - 1) * in_no_time;
  }

  void cores_and_units() {
    const FpuConfig& fpu = chip_.cluster.fpu;
    logic("core", Domain::Cores, cores_, core(chip_.cluster.core));
    logic("floating-point unit", Domain::Fpu, fpu.units, n_.fpu);
    logic("divider", Domain::Fpu, fpu.dividers, n_.divider);
    logic("unit for 64-bit integers", Domain::Fpu, fpu.int64_units, n_.int64_unit);
    const double choices = fpu.mapping == FpuMapping::Dynamic ? fpu.units : std::min(fpu.units, 1);
    logic("network of these units", Domain::Fpu, cores_ * (choices + fpu.dividers),
          n_.fpu_crosspoint);
  }

  void memories_of_cluster() {
    const ClusterConfig& cluster = chip_.cluster;
    const double banks_of_l1 = cluster.l1.banks;
    private_cache("instruction cache of a worker", Domain::Cluster, cores_ - 1,
                  cluster.icache.worker, cluster.icache);
    private_cache("instruction cache of the master", Domain::Cluster, 1, cluster.icache.master,
                  cluster.icache);
    shared_cache(cluster.icache);
    banks("bank of L1", Domain::L1, banks_of_l1, Bytes(cluster.l1.size.count() / cluster.l1.banks));
    // The DMA reads and writes at once.
    const double dma_ports = 2 * std::ceil(cluster.dma.bytes_per_cycle / kPortBytes);
    logic("network of L1", Domain::L1, (cores_ + dma_ports + n_.l1_masters) * banks_of_l1,
          n_.memory_crosspoint);
  }

  void rest_of_cluster() {
    const ClusterConfig& cluster = chip_.cluster;
    const int commands = cluster.dma.commands;
    logic("DMA", Domain::Dma, 1,
          n_.dma + n_.dma_byte * cluster.dma.bytes_per_cycle + n_.dma_command * commands);
    items_.back().known = commands > 0;  // else any number, of which nobody knows the size
    logic("event unit", Domain::Cluster, cores_, n_.event_unit);
    // Code and data take the same way to L2. No more than a line comes at once.
    logic("buses and control", Domain::Cluster, 1,
          n_.cluster_rest + n_.cluster_bus_byte * std::max(cluster.dma.bytes_per_cycle,
                                                           bytes_of_code(cluster.icache)));
    if (n_.not_simulated > KiloGates(0))
      logic("accelerator not simulated", Domain::Cluster, 1, n_.not_simulated);
  }

  void accelerators(std::string_view kind, Domain domain, const Accelerators& all,
                    const AreaConfig::Accelerators& sizes) {
    for (const work::OffloadKindInfo& kernel : work::kOffloadKinds) {
      const std::size_t k = work::index(kernel.kernel);
      logic(std::string(kind) + " " + std::string(kernel.name), domain, all[k].units, sizes[k]);
      if (all[k].units > 0) items_.back().known = sizes[k] > KiloGates(0);
    }
  }

  void controller_and_soc() {
    const double cuts = l2_cuts(chip_);
    logic("controller", Domain::Controller, 1,
          core(chip_.controller.core) + n_.fpu + n_.divider + n_.controller_rest +
              n_.controller_bus_byte * bytes_of_code(chip_.controller.icache));
    private_cache("instruction cache of the controller", Domain::Controller, 1,
                  chip_.controller.icache.worker, chip_.controller.icache);
    banks("block of L2", Domain::L2, cuts, n_.l2_cut);
    logic("network of L2", Domain::L2, n_.l2_masters * cuts, n_.memory_crosspoint);
    logic("peripherals and control", Domain::Soc, 1, n_.soc_rest);
  }

  const ChipConfig& chip_;
  const AreaConfig& n_;
  double cores_;  ///< workers and master
  std::vector<AreaItem> items_;
};

// Numbers that may err: not those of the chip's make, such as where blocks end.
constexpr std::array kAreas{&AreaConfig::gate, &AreaConfig::sram_cut, &AreaConfig::sram_bit,
                            &AreaConfig::latch_bit};
constexpr std::array kGates{&AreaConfig::core,
                            &AreaConfig::xpulp,
                            &AreaConfig::fpu,
                            &AreaConfig::divider,
                            &AreaConfig::fpu_crosspoint,
                            &AreaConfig::private_cache,
                            &AreaConfig::shared_cache,
                            &AreaConfig::cache_way,
                            &AreaConfig::refill_buffer,
                            &AreaConfig::int64_unit,
                            &AreaConfig::dma_command,
                            &AreaConfig::controller_bus_byte,
                            &AreaConfig::dma,
                            &AreaConfig::dma_byte,
                            &AreaConfig::memory_crosspoint,
                            &AreaConfig::event_unit,
                            &AreaConfig::cluster_bus_byte,
                            &AreaConfig::cluster_rest,
                            &AreaConfig::not_simulated,
                            &AreaConfig::controller_rest,
                            &AreaConfig::soc_rest};
constexpr std::array kPorts{&AreaConfig::l1_masters, &AreaConfig::l2_masters};

/// Calls `visit` with `to` having one number of `from`, for each number that differs.
template <class Visit>
void with_each(const AreaConfig& from, AreaConfig to, Visit visit) {
  const auto with = [&](const auto& other, auto& number) {
    if (number == other) return;
    const auto before = number;
    number = other;
    visit(to);
    number = before;
  };
  for (const auto member : kAreas) with(from.*member, to.*member);
  for (const auto member : kGates) with(from.*member, to.*member);
  for (const auto member : kPorts) with(from.*member, to.*member);
  for (std::size_t k = 0; k < work::kOffloadKindCount; ++k) {
    with(from.cluster_accelerators[k], to.cluster_accelerators[k]);
    with(from.controller_accelerators[k], to.controller_accelerators[k]);
  }
}

/// Sums of an item or of several: the same function of the items of every set of numbers.
template <class Sum>
void add_band(const ChipConfig& chip, AreaItem& item, Sum sum) {
  const double value = item.area.count();
  const auto far = [&](const AreaConfig& end) {
    double squares = 0;
    with_each(end, chip.area.value, [&](const AreaConfig& numbers) {
      squares += std::pow(sum(Parts(chip, numbers).list()).count() - value, 2);
    });
    return SquareMicrometres(std::sqrt(squares));
  };
  item.low = std::max(item.area - far(chip.area.low), SquareMicrometres{});
  item.high = item.area + far(chip.area.high);
}

template <class Predicate>
AreaItem sum_of(const ChipConfig& chip, const char* name, Predicate counts) {
  AreaItem sum{name, Domain::Soc, 1, {}, {}, {}, {}};
  const auto area = [&](const std::vector<AreaItem>& items) {
    SquareMicrometres all;
    for (const AreaItem& item : items)
      if (counts(item.domain)) all += item.area;
    return all;
  };
  const std::vector<AreaItem> items = Parts(chip, chip.area.value).list();
  sum.area = area(items);
  for (const AreaItem& item : items) {
    if (!counts(item.domain)) continue;
    sum.gates += item.gates;
    sum.known = sum.known && item.known;
  }
  add_band(chip, sum, area);
  return sum;
}

}  // namespace

bool knows_area(const ChipConfig& chip) { return chip.area.value.gate > SquareMicrometres(0); }

std::vector<AreaItem> areas_of(const ChipConfig& chip) {
  check(knows_area(chip), "area of a chip without areas");
  std::vector<AreaItem> items = Parts(chip, chip.area.value).list();
  for (std::size_t i = 0; i < items.size(); ++i)
    add_band(chip, items[i], [i](const std::vector<AreaItem>& all) { return all[i].area; });
  return items;
}

bool is_of_cluster(Domain domain) {
  return domain == Domain::Cores || domain == Domain::Fpu || domain == Domain::L1 ||
         domain == Domain::Dma || domain == Domain::Cluster;
}

AreaItem cluster_area(const ChipConfig& chip) { return sum_of(chip, "cluster", is_of_cluster); }

AreaItem total_area(const ChipConfig& chip) {
  return sum_of(chip, "chip", [](Domain) { return true; });
}

GatesByDomain gates_by_domain(const ChipConfig& chip) {
  GatesByDomain sums{};
  if (!knows_area(chip)) return sums;
  for (const AreaItem& item : Parts(chip, chip.area.value).list())
    sums[index(item.domain)] += item.gates;
  return sums;
}

double l2_cuts(const ChipConfig& chip) {
  const Bytes cut = chip.area.value.l2_cut;
  if (cut == Bytes(0)) return 0;
  return std::ceil(static_cast<double>(chip.l2.size.count()) / static_cast<double>(cut.count()));
}

}  // namespace leviosim::sim
