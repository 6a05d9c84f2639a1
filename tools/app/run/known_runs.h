// Replays that are known from others: where jobs take as many cycles on one chip as on another,
// which differs in clocks, supply, energies, areas, or memory to spare, only camera, queue and
// optimiser are simulated again, with the cycles that each job took. The results are those of
// replay(), byte by byte.
//
// Left out: runs in which other frames are processed or other optimisations begin than in the one
// that is known; they are replayed.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "tools/app/run/replay.h"

namespace leviosim::tools {

/// The replays of one study. May be used by several threads at once.
class KnownRuns {
 public:
  /// Same result as replay(). @param trace  outlives the results
  Replay replay(const traces::WorkTrace& trace, const RunRequest& request,
                const ProgressCallback& progress);
  /// Number of replays whose times were known.
  std::size_t repeated() const;

 private:
  struct Run;

  /// A run whose jobs take as many cycles; null if there is none.
  std::shared_ptr<const Run> find(const traces::WorkTrace& trace, const RunRequest& request) const;
  void keep(std::shared_ptr<const Run> run);

  mutable std::mutex mutex_;
  std::vector<std::shared_ptr<const Run>> runs_;
  std::size_t repeated_ = 0;
};

}  // namespace leviosim::tools
