// Uncertainty of the times of a run: a sample of its frames, timed again with every uncertain
// number of the platform at both ends of its range.
//
// Left out: frames outside the sample, and most of the forks of one name in a stage, such as the
// hypotheses of a RANSAC. Their relative bands differ from those of the sample by little.
#pragma once

#include <cstddef>
#include <vector>

#include "sim/work/program.h"
#include "tools/app/result/run_result.h"
#include "tools/app/run/run_request.h"

namespace leviosim::tools {

/// Jobs of a run: the slowest frame, a few others spread over it, the longest iteration.
class JobSample {
 public:
  /// In the order of the run.
  void add_frame(const work::Job& job, Cycles cycles);
  void add_iteration(const work::Job& job, const sim::JobTiming& timing);

  bool empty() const { return slowest_.cycles == Cycles(0); }
  const work::Job& slowest() const { return slowest_.job; }
  const std::vector<work::Job>& spread() const { return spread_; }
  /// Without stages if the optimiser did not run.
  const work::Job& iteration() const { return iteration_.job; }

 private:
  struct Longest {
    work::Job job;
    Cycles cycles;
    void take(const work::Job& other, Cycles its);
  };
  Longest slowest_;
  Longest iteration_;
  std::vector<work::Job> spread_;  ///< every stride-th
  std::size_t frames_ = 0;
  std::size_t stride_ = 1;
};

/// @param cores    that ran the jobs
/// @param threads  as of range_bands(); of the slowest frame alone, 1
TimeBands time_bands(const platform::ResolvedPlatform& platform, int cores, const JobSample& sample,
                     TimeBandsOf which, unsigned threads = 0);

}  // namespace leviosim::tools
