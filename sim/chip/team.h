// Cores of a cluster that run work segments at the same time and share units.
//
// Whenever a core starts or ends a work segment, or the DMA begins or ceases to move data, the
// rates of all running cores are solved again (contention.h), once per instant, and their ends are
// moved. No cycle is stepped.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "sim/chip/accelerator.h"
#include "sim/chip/contention.h"
#include "sim/chip/cost.h"
#include "sim/chip/dma.h"
#include "sim/chip/team_memory.h"

namespace leviosim::sim {

/// A work segment that one core of a team executes. Instants are in cycles since the job began.
struct TeamShare {
  int core = 0;
  const work::Segment* work = nullptr;
  Cycles begin;
  OperationAccounts* by_operation = nullptr;  ///< gets what of it each kind of operation has
  // Of these, the team says:
  Cycles end{};
  MechanismCycles time{};  ///< what the core's cycles were spent on; adds up to those it took
};

class Team {
 public:
  /// @param workers  ids 0 … workers-1; the master is core `workers`
  Team(const ClusterConfig& config, int workers);

  /// Executes shares of different cores, and says when they end.
  /// @param work  what they are shares of, for the memory; null if it is not to be known
  void execute(std::span<TeamShare> shares, const Traffic& traffic, const void* work = nullptr);

  /// What is executed from now on is added to the memory, or taken from it where it takes as long
  /// (and nobody asks for kinds of operation). Null ends that. The memory outlives the team.
  void remember(TeamMemory* memory) { learning_ = memory; }
  void recall(const TeamMemory* memory);

 private:
  /// A share that has begun and not ended.
  struct Running {
    TeamShare* share;
    const LoneCycles* alone;
    double remaining;  ///< lone cycles still to do
    Cycles end{};      ///< at the present rates
  };

  void price(std::span<const TeamShare> shares, const TeamMemory::Execution* known);
  /// Whether a segment asks for the same on the chip that is remembered, whatever it counted.
  bool asks_the_same(const work::Segment& segment) const;
  void walk(std::span<TeamShare> shares, Cycles now, const Traffic& traffic);
  /// Whether it takes as long as what is known, which it is then.
  bool repeats(std::span<TeamShare> shares, Cycles now, const Traffic& traffic,
               const TeamMemory::Execution& known) const;
  void learn(std::span<const TeamShare> shares, Cycles begin, const void* work);
  void begin(TeamShare& share, const Demand& demand);
  /// Sets rates and ends of all that run. Returns the first end.
  Cycles solve(Cycles now, double dma_words);
  void work(Cycles cycles);
  /// Of those that end now. Returns how many there are.
  std::size_t end_all(Cycles now);

  ClusterConfig config_;
  CoreCosts costs_;
  CodeFetcher worker_code_;
  CodeFetcher master_code_;
  int master_;
  Contention contention_;
  std::vector<Demand> demands_;   ///< of the shares
  std::vector<Running> running_;  ///< in the order of their cores
  std::vector<Runner> runners_;   ///< the same as the contention solver sees them
  std::vector<Progress> progress_;
  TeamMemory* learning_ = nullptr;
  const TeamMemory* recalling_ = nullptr;
  bool same_cores_ = false;
  /// That cost something else there; nothing if more of the cores differs.
  std::optional<std::vector<std::size_t>> other_operations_;
  bool same_sharing_ = false;
};

}  // namespace leviosim::sim
