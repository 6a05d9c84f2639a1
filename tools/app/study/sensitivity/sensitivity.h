// How much hangs on each number of a platform that is not certain: every one that has a range is
// set to both its ends, one at a time, and the jobs of one recorded run are timed again.
//
// Left out: energies and supply voltages, which no time depends on (their bands are carried through
// the energy model, sim/energy/estimate.h); what another timing would have changed in the
// computation (a late optimiser result), and ranges that hang together, such as the halves of a
// cost that is known only in sum.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "platform_models/loader/variants.h"
#include "tools/app/study/runner.h"
#include "tools/app/table/banded.h"
#include "traces/work_traces/work_trace.h"

namespace leviosim::tools {

/// Mean times on one chip, in ms; absent if the run had no such job.
struct MeanTimes {
  std::optional<double> frame;        ///< front end, all frames but the first
  std::optional<double> epnp;         ///< … from EPnP
  std::optional<double> eight_point;  ///< … from the 8-point algorithm
  std::optional<double> iteration;    ///< of the optimiser, with its share of updates
  /// Stages in the order in which they came first, with the kcycles of a mean call.
  std::vector<std::pair<std::string, double>> stages;

  /// Absent if there is no such stage.
  std::optional<double> stage(std::string_view name) const;
};

/// Frame by frame, without a camera and without queues. @param workers  cores of the team
MeanTimes time_on(const sim::ChipConfig& chip, int workers, const traces::WorkTrace& trace);

/// One number at both ends of its range.
struct Swing {
  platform::Parameter parameter;
  MeanTimes low;
  MeanTimes high;
  bool is_in_bands = true;  ///< run/range_bands.h
};

struct Sensitivity {
  MeanTimes base;
  std::vector<Swing> swings;           ///< the largest effect first
  std::vector<std::string> unbounded;  ///< uncertain numbers without a range
};

/// Change against the base in per cent; absent where one of them is, and without a base.
std::optional<double> percent_change(std::optional<double> value, std::optional<double> base);

/// Largest absolute change of the frame time at either end, in per cent.
double effect_on_frame(const Swing& swing, const MeanTimes& base);

/// What a stage takes if no number with a range is certain: the changes at the ends of the ranges,
/// taken as independent, so as the root of the sum of their squares.
struct StageBand {
  std::string stage;
  Banded kcycles;  ///< of a mean call
};
std::vector<StageBand> stage_bands(const Sensitivity& sensitivity);

Sensitivity sensitivity(const platform::Variants& platform, int workers,
                        const traces::WorkTrace& trace, const RunnerOptions& options);

}  // namespace leviosim::tools
