// What the ranges of a platform's numbers (platform_models/FORMAT.md) leave of figures that a chip
// yields: every number on which times depend is set to both ends of its range, one at a time, and
// the figures are taken again.
//
// Left out: energies, areas and what the supply allows, which no time depends on; ranges that hang
// together, such as the halves of a cost that is known only in sum.
#pragma once

#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "platform_models/loader/variants.h"
#include "sim/work/program.h"
#include "tools/app/result/run_result.h"
#include "tools/app/run/run_request.h"
#include "tools/app/table/banded.h"

namespace leviosim::tools {

/// Whether times depend on a number of this name.
bool is_of_time(const platform::Parameter& parameter);

/// Those with a range on which times depend; of the platform, which outlives them.
std::vector<const platform::Parameter*> ranged(const platform::ResolvedPlatform& platform);

/// What a chip yields with one number at both ends of its range.
template <class T>
struct AtEnds {
  const platform::Parameter* parameter;
  T low;
  T high;
};

/// Calls every job once, in any order, maybe on several threads.
using RunJobs = std::function<void(std::size_t, const std::function<void(std::size_t)>&)>;

/// Whether an end of the range is the number itself.
bool is_end(const platform::Parameter& parameter, double end);

/// @param base  of the platform as it is
/// @param of    T of a sim::ChipConfig; may be called by several threads
template <class T, class Of>
std::vector<AtEnds<T>> at_ends(const platform::Variants& platform,
                               const std::vector<const platform::Parameter*>& parameters,
                               const T& base, const Of& of, const RunJobs& run) {
  std::vector<AtEnds<T>> all;
  std::vector<std::pair<T*, platform::Change>> jobs;
  for (const platform::Parameter* parameter : parameters) all.push_back({parameter, base, base});
  for (AtEnds<T>& ends : all) {
    const platform::Range& range = *ends.parameter->range;
    for (const auto& [outcome, end] : {std::pair(&ends.low, range.low), {&ends.high, range.high}})
      if (!is_end(*ends.parameter, end)) jobs.push_back({outcome, {ends.parameter->path, end}});
  }
  run(jobs.size(), [&](std::size_t i) { *jobs[i].first = of(platform.config({jobs[i].second})); });
  return all;
}

/// Whether bands are of this number, too. They are not of what compilers make of single operations
/// (isa.ops.*.issue but of routines, isa.ops.loop_*): how many instructions they make of all that
/// was counted was measured, or has a range, isa.unmeasured_instructions.
bool is_in_bands(const platform::Parameter& parameter, const sim::ChipConfig& chip);

/// Instructions that other compilers make of measured code, for each of the compiler that it was
/// measured with (FACTS.md#other-compilers). In bands, though no number of a platform.
inline constexpr platform::Range kOtherCompilers{0.93, 1.27};

/// The figures of one chip, always as many.
using ChipFigures = std::function<std::vector<double>(const sim::ChipConfig&)>;

/// The figures with the bands of all numbers together.
/// @param figures  called by several threads
/// @param threads  0: as many as the host has; the bands do not depend on it
std::vector<Banded> range_bands(const platform::Variants& platform, const ChipFigures& figures,
                                unsigned threads = 0);

// How far the times of a run may be off: a few of its frames, timed again with every uncertain
// number of the platform at both ends of its range.
//
// Left out: other frames than those kept, and of forks of one name in a stage, such as the
// hypotheses of a RANSAC, all but a few. They differ in how much they have of what a number
// changes, which is small beside the bands.

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
