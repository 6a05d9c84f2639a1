// Many runs, native or on a chip: on all cores of the host, each found again if it has been done
// before.
#pragma once

#include <functional>
#include <vector>

#include "tools/app/study/batch/run_cache.h"
#include "tools/app/study/batch/sequence.h"

namespace leviosim::tools {

/// One run of a batch.
struct BatchRun {
  const Sequence* sequence;
  RunRequest request;  ///< its trajectory is compared with the truth of the sequence
};

struct BatchProgress {
  std::size_t done = 0;   ///< of the runs
  std::size_t found = 0;  ///< of these, in the cache
  std::size_t total = 0;
};

struct BatchOptions {
  Measure measure;
  RunCache cache;
  unsigned threads = 0;  ///< 0: as many as the host has; the outcomes do not depend on it
};

/// Outcomes in the order of the runs. What is finished is in the cache at once, whatever becomes of
/// the rest.
/// @param progress  called by one thread at a time
/// @throws InputError for data that cannot be used, Interrupted
std::vector<RunOutcome> run_batch(const std::vector<BatchRun>& runs, const BatchOptions& options,
                                  const std::function<void(const BatchProgress&)>& progress);

}  // namespace leviosim::tools
