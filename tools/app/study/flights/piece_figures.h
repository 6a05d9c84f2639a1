// What a benchmark of flights comes to: runs condensed to pieces, pieces to rows. Worlds, starts
// and random draws are kept apart. A piece counts once, with the median of its seeds; a row has the
// median of its pieces, and says how far that would move with other pieces, and with other seeds.
#pragma once

#include <optional>
#include <vector>

#include "tools/app/study/accuracy_study.h"
#include "tools/app/study/flights/benchmark.h"
#include "tools/app/study/flights/flight_plan.h"
#include "tools/app/study/point.h"
#include "tools/app/study/spread.h"

namespace leviosim::tools {

/// ATE over the length of the true path; none if the run diverged. [%]
std::optional<double> error_percent(const RunOutcome& outcome);

/// The same without poses that are guesses, which a run names apart: what its verdict is about.
std::optional<double> judged_percent(const RunOutcome& outcome);

/// Beyond it a run failed, whether it is lost or only wrong. [% of the path]
inline constexpr double kFailedPercent = 10;
/// Up to it a run is right. [%]
inline constexpr double kRightPercent = 3;
/// Beyond it nobody may call a run good. [%]
inline constexpr double kSilentPercent = 20;

/// What runs said of themselves at their end, against what they were. Runs that say nothing, for
/// their front end has no "health", do not count; nor do poses that a run calls guesses.
struct Alarms {
  std::size_t runs = 0;      ///< that say something
  std::size_t failed = 0;    ///< of these
  std::size_t detected = 0;  ///< of the failed: that do not call themselves good
  std::size_t right = 0;
  std::size_t false_alarms = 0;  ///< of the right: that do not call themselves good
  std::size_t silent = 0;        ///< error above kSilentPercent, and good

  void add(const RunOutcome& outcome);
};

/// Whether a run diverged, is lost, or has an error above kFailedPercent.
bool failed(const RunOutcome& outcome);

/// A variant on a piece, over the seeds.
struct PieceRow {
  std::size_t variant = 0;  ///< of the plan
  std::size_t piece = 0;    ///< of the benchmark
  Spread percent;           ///< ATE over the path [%]
  Spread metres;            ///< ATE
  Spread scale;             ///< means over windows, of runs that have one
  Spread scale_sigma;       ///< of runs with two windows or more
  Spread end_drift;         ///< of runs whose path is long enough
  std::size_t diverged = 0;
  std::size_t failed = 0;        ///< runs, those that diverged among them
  std::size_t map_restarts = 0;  ///< of all runs
  Alarms alarms;
};

/// An error over the pieces of a row. What does not exist is that of runs that diverged.
struct RowError {
  std::optional<double> median;  ///< of the pieces
  MedianInterval over_pieces;
  MedianInterval over_seeds;    ///< of medians over the pieces, one for each seed
  std::optional<double> worst;  ///< of all runs
};

/// A variant on all pieces of a length, set, motion and disturbance.
struct BenchmarkRow {
  std::size_t variant = 0;
  std::size_t length = kWholeFlight;
  std::size_t set = 0;
  std::optional<std::size_t> motion;  ///< none: all of them
  std::size_t disturbance = 0;
  std::size_t pieces = 0;
  std::size_t runs = 0;
  std::size_t diverged = 0;
  std::size_t failed = 0;
  std::size_t map_restarts = 0;
  Alarms alarms;
  RowError percent;
  RowError metres;
  Spread scale;        ///< of the runs that have one
  Spread scale_sigma;  ///< likewise
  Spread end_drift;    ///< likewise
};

struct BenchmarkResult {
  std::vector<PieceRow> pieces;  ///< by row_of()
  std::vector<BenchmarkRow>
      rows;  ///< by variant, length, set, disturbance, motion; all motions last
};

/// @param runs  benchmark_runs()
BenchmarkResult condense(const Benchmark& benchmark, const std::vector<Point>& runs,
                         const std::vector<RunOutcome>& outcomes);

}  // namespace leviosim::tools
