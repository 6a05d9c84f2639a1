// Bands of a chip's figures from the ranges of its numbers (platform_models/FORMAT.md): every
// number on which times depend is set to both ends of its range, one at a time, and the figures are
// computed again.
//
// Left out: energies, areas and supply, on which no time depends; correlated ranges, such as the
// two parts of a cost that is known only in sum.
#pragma once

#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "platform_models/loader/variants.h"
#include "tools/app/table/banded.h"

namespace leviosim::tools {

/// Whether times depend on the number.
bool is_of_time(const platform::Parameter& parameter);

/// The numbers of the platform with a range on which times depend. The platform outlives them.
std::vector<const platform::Parameter*> uncertain_numbers(
    const platform::ResolvedPlatform& platform);

/// A result with one number at both ends of its range.
template <class T>
struct AtEnds {
  const platform::Parameter* parameter;
  T low;
  T high;
};

/// Calls every job once, in any order, possibly on several threads.
using RunJobs = std::function<void(std::size_t, const std::function<void(std::size_t)>&)>;

/// Whether an end of the range is the number itself.
bool is_end(const platform::Parameter& parameter, double end);

/// @param base  the result of the platform as it is
/// @param of    computes T for a sim::ChipConfig; may be called by several threads
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

/// Whether bands include this number. They leave out the instructions of single operations
/// (isa.ops.*.issue except routines, isa.ops.loop_*): the instructions that compilers make of all
/// operations together were measured, or have a range, isa.unmeasured_instructions.
bool is_in_bands(const platform::Parameter& parameter, const sim::ChipConfig& chip);

/// Instructions of other compilers over those of the compiler that the code was measured with
/// (FACTS.md#other-compilers). Part of the bands, though no number of a platform.
inline constexpr platform::Range kOtherCompilers{0.93, 1.27};

/// The figures of one chip; always the same number of them.
using ChipFigures = std::function<std::vector<double>(const sim::ChipConfig&)>;

/// The figures with the bands of all numbers together.
/// @param figures  called by several threads
/// @param threads  0: as many as the host has; the bands do not depend on it
std::vector<Banded> range_bands(const platform::Variants& platform, const ChipFigures& figures,
                                unsigned threads = 0);

}  // namespace leviosim::tools
