// What executions of a team took on one chip, for chips of which some numbers are others: where an
// execution depends on none of these, it takes as long there. That is known by the structures of
// the configuration that differ, and, of a core and its caches, by what segments ask for then.
//
// Left out: executions beside transfers of the DMA, which are timed anew.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "sim/chip/config.h"
#include "sim/chip/cost.h"

namespace leviosim::sim {

class TeamMemory {
 public:
  /// A share, with its instants since the execution began.
  struct Share {
    Cycles begin;
    Cycles end;
    Demand demand;
    MechanismCycles time;
  };
  using Execution = std::vector<Share>;

  /// @param config  of the cluster that executes what is remembered
  explicit TeamMemory(const ClusterConfig& config) : config_(config) {}

  /// @param work  the step of a job that outlives the memory
  void add(const void* work, Execution execution) { executions_[work] = std::move(execution); }
  /// Null if nothing is known.
  const Execution* find(const void* work) const {
    const auto found = executions_.find(work);
    return found == executions_.end() ? nullptr : &found->second;
  }

  /// Whether each segment asks for the same on another cluster.
  bool has_cores_of(const ClusterConfig& other) const;
  /// If only costs of operations differ, which: segments without these ask for the same.
  std::optional<std::vector<std::size_t>> operations_that_differ(const ClusterConfig& other) const;
  /// Whether segments that ask for the same take as long beside each other.
  bool shares_as(const ClusterConfig& other) const;

 private:
  ClusterConfig config_;
  std::unordered_map<const void*, Execution> executions_;  ///< by what was executed
};

}  // namespace leviosim::sim
