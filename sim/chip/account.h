// Where core-cycles go: the one account from which breakdowns, comparisons, energy and timelines
// read. A cluster or controller books into it what each work segment took on its core, and what the
// team waited for around it.
//
// Its dimensions: stage (one CycleAccount each), fork, mechanism, kind of operation. Its unit is
// the core-cycle of the team: with W workers, a stage of T cycles has W·T of them. What the master
// does beside the workers in a fork is not in it.
//
// A further mechanism is an enumerator and its row in kMechanisms, and what books it.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "sim/work/offload_regions.h"

namespace leviosim::sim {

/// What core-cycles are spent on.
enum class Mechanism : std::uint8_t {
  // Of a core that runs alone: known by kind of operation.
  Issue,
  LoadUse,
  Control,
  Memory,
  Arithmetic,
  Fetch,
  Accelerator,
  // Of a core that runs beside others.
  Fpu,
  Divider,
  Banks,
  FetchContention,
  AcceleratorContention,
  // Of the team.
  Imbalance,
  Synchronisation,
  Transfer,
  Serial,
  Rounding,
  // Of a job as a whole, in no stage.
  Offload,
};
inline constexpr std::size_t kLoneMechanismCount = static_cast<std::size_t>(Mechanism::Fpu);
inline constexpr std::size_t kCoreMechanismCount = static_cast<std::size_t>(Mechanism::Imbalance);
inline constexpr std::size_t kMechanismCount = static_cast<std::size_t>(Mechanism::Offload) + 1;

constexpr std::size_t index(Mechanism mechanism) { return static_cast<std::size_t>(mechanism); }

struct MechanismInfo {
  Mechanism mechanism;
  std::string_view key;     ///< in files and statistics
  std::string_view column;  ///< of tables and charts, which it is added to; empty: of none
  std::string_view wait;    ///< what the core waits for while it works; empty: for nothing
  std::string_view meaning;
  bool sleeps = false;  ///< its cores wait for an event, with their clocks off
};

/// In the order in which tables list them.
inline constexpr std::array kMechanisms{
    MechanismInfo{Mechanism::Issue, "issue", "useful", "", "instructions"},
    MechanismInfo{Mechanism::LoadUse, "load_use", "useful", "", "waiting for loaded values"},
    MechanismInfo{Mechanism::Control, "control", "useful", "",
                  "pipeline refills after branches, calls, loop entries"},
    MechanismInfo{Mechanism::Memory, "memory", "useful", "", "L2 latency and straddling words"},
    MechanismInfo{Mechanism::Arithmetic, "arithmetic", "useful", "",
                  "latency of divisions and floating point"},
    MechanismInfo{Mechanism::Fpu, "fpu", "FPU", "FPU", "waiting for a shared FPU"},
    MechanismInfo{Mechanism::Divider, "divider", "divider", "divider",
                  "waiting for the shared divider"},
    MechanismInfo{Mechanism::Banks, "banks", "L1 banks", "L1 banks", "waiting for L1 banks"},
    MechanismInfo{Mechanism::Fetch, "fetch", "code", "code", "waiting for code"},
    MechanismInfo{Mechanism::FetchContention, "fetch_contention", "code", "code",
                  "waiting for code while others fetch"},
    MechanismInfo{Mechanism::Imbalance, "imbalance", "slowest core", "",
                  "waiting for the slowest core", true},
    MechanismInfo{Mechanism::Synchronisation, "synchronisation", "sync", "",
                  "forking, waking up, barriers", true},
    MechanismInfo{Mechanism::Transfer, "transfer", "DMA", "", "waiting for the DMA", true},
    MechanismInfo{Mechanism::Serial, "serial", "serial", "", "the master works alone", true},
    MechanismInfo{Mechanism::Rounding, "rounding", "slowest core", "", "ends moved to clock edges"},
    MechanismInfo{Mechanism::Accelerator, "accelerator", "served", "accelerator",
                  "accelerators serving the core"},
    MechanismInfo{Mechanism::AcceleratorContention, "accelerator_contention", "queue",
                  "accelerator", "accelerators serving other cores"},
    MechanismInfo{Mechanism::Offload, "offload", "", "", "calling the cluster, and its answer"},
};
constexpr bool every_mechanism_has_a_row() {
  std::array<int, kMechanismCount> rows{};
  for (const MechanismInfo& info : kMechanisms) ++rows[index(info.mechanism)];
  for (const int n : rows)
    if (n != 1) return false;
  return true;
}
static_assert(every_mechanism_has_a_row(), "kMechanisms must list every Mechanism once");

/// Cycles by mechanism, of the first N.
template <std::size_t N>
class CyclesBy {
 public:
  double& operator[](Mechanism mechanism) { return of_[index(mechanism)]; }
  double operator[](Mechanism mechanism) const { return of_[index(mechanism)]; }

  double total() const { return sum(0, N); }
  /// Of a core as if it ran alone.
  double alone() const { return sum(0, kLoneMechanismCount); }
  /// For units that others use at the same time.
  double waiting() const { return sum(kLoneMechanismCount, kCoreMechanismCount); }

  template <std::size_t M>
  CyclesBy& operator+=(const CyclesBy<M>& other) {
    return add(other, 1);
  }
  template <std::size_t M>
  CyclesBy& add(const CyclesBy<M>& other, double times) {
    static_assert(M <= N);
    for (std::size_t i = 0; i < M; ++i) of_[i] += times * other.of_[i];
    return *this;
  }
  /// Only what waiting() has.
  template <std::size_t M>
  CyclesBy& add_waiting(const CyclesBy<M>& other, double times) {
    static_assert(M <= N && M >= kCoreMechanismCount);
    for (std::size_t i = kLoneMechanismCount; i < kCoreMechanismCount; ++i)
      of_[i] += times * other.of_[i];
    return *this;
  }

 private:
  template <std::size_t>
  friend class CyclesBy;

  double sum(std::size_t first, std::size_t end) const {
    double cycles = 0;
    for (std::size_t i = first; i < end; ++i) cycles += of_[i];
    return cycles;
  }

  std::array<double, N> of_{};
};
/// Of a core that runs alone.
using LoneCycles = CyclesBy<kLoneMechanismCount>;
/// Of a core that runs beside others.
using CoreCycles = CyclesBy<kCoreMechanismCount>;
using MechanismCycles = CyclesBy<kMechanismCount>;

/// What is counted beside cycles: operations of a kind, bytes of code, items that an accelerator
/// serves.
struct OperationAccount {
  double count = 0;
  LoneCycles cycles;
};

/// First the operations of cores (work::Op), then code, then what accelerators serve.
inline constexpr std::size_t kCodeOperation = work::kOpCount;
inline constexpr std::size_t kOperationCount = work::kOpCount + 1 + work::kOffloadKindCount;
using OperationAccounts = std::array<OperationAccount, kOperationCount>;
constexpr std::size_t operation_of(work::OffloadKind kernel) {
  return kCodeOperation + 1 + work::index(kernel);
}
/// Name of a kind: "f32_add", "code", "eigen3".
std::string_view operation_name(std::size_t operation);

/// The fork of what the master or the controller does alone.
inline constexpr std::string_view kSerialFork = "serial";

/// The forks of one name in a stage. Cycles are of the cores that worked or waited.
struct ForkAccount {
  std::string name;   ///< kSerialFork, or empty for what is done between forks: transfers
  double weight = 1;  ///< core-cycles of the team in a cycle: all wait while the master works alone
  MechanismCycles cycles;
  /// What of the cycles of lone cores is known by kind of operation, which is all of it.
  OperationAccounts operations{};

  ForkAccount& operator+=(const ForkAccount& other);
};

/// The account of a stage, of one execution or many.
struct CycleAccount {
  /// Core-cycles of the team. Those of kSerialFork are one mechanism here, except on a controller,
  /// which is always alone.
  MechanismCycles team;
  /// In the order in which they came; their weighted cycles add up to those of the team. Empty
  /// where nobody asked for them.
  std::vector<ForkAccount> forks{};

  /// Adds one if there is none of that name.
  ForkAccount& fork(std::string_view name, double weight = 1);
  double total() const { return team.total(); }
  CycleAccount& operator+=(const CycleAccount& other);
};

}  // namespace leviosim::sim
