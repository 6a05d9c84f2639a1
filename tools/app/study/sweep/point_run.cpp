#include "tools/app/study/sweep/point_run.h"

#include <algorithm>
#include <array>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/interruption.h"
#include "tools/app/budget/figures.h"
#include "tools/app/cli/host.h"
#include "tools/app/record/statistics.h"
#include "tools/app/run/known_runs.h"
#include "tools/app/run/replay.h"
#include "tools/app/run/run_request.h"
#include "tools/app/run/simulate.h"
#include "tools/app/run/trace_source.h"
#include "tools/app/study/sweep/points.h"

namespace leviosim::tools {
namespace {

/// How the replay compares with what is on record. Where the algorithm would have computed
/// something else, nothing is known of its accuracy.
void add_comparison(const Replay& replay, std::vector<Statistic>& statistics) {
  const auto differs = [](const FrameComparison& f) { return !f.computes_the_same(); };
  const auto count = std::count_if(replay.frames.begin(), replay.frames.end(), differs);
  const auto add = [&](const char* name, double value) {
    statistics.push_back({.name = name, .unit = "1", .value = value});
  };
  add("replay.differing_frames", static_cast<double>(count));
  if (count == 0) return;
  const auto first = std::find_if(replay.frames.begin(), replay.frames.end(), differs);
  add("replay.first_differing_frame", static_cast<double>(first->frame));
  std::erase_if(statistics, [](const Statistic& s) { return s.name.starts_with("accuracy."); });
}

RunRecord record_of(const RunResult& run) {
  RunRecord record = reduced({figures_of(run)}, Level::figures);
  std::erase_if(record.statistics, [](const Statistic& s) { return !s.value; });
  return record;
}

RunRecord computed(const ResolvedPoint& point, KnownRuns& known) {
  const auto progress = [](const Progress&) { throw_if_interrupted(); };
  if (point.trace == nullptr) return record_of(simulate(point.request, progress));
  const Replay replayed = known.replay(*point.trace, point.request, progress);
  RunRecord record = record_of(replayed.run);
  add_comparison(replayed, record.statistics);
  return record;
}

}  // namespace

RunRecord run_point(const ResolvedPoint& point, KnownRuns& known) {
  try {
    return computed(point, known);
  } catch (const InputError& error) {
    RunRecord record;
    record.failure = error.what();
    return record;
  }
}

}  // namespace leviosim::tools
