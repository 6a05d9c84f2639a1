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

}  // namespace leviosim::tools
