// What a benchmark of flights runs: motions, texture worlds in sets, pieces, variants of the
// workload, seeds. A plan is part of the program and has a name, or a file:
//
//   motions: [MH_01_easy, V1_02_medium]      # folders, where the user says
//   worlds:                                   # seeds of what is drawn, or workshop:1, 0.3m:1
//                                             # (place.h), in sets
//     development: [1, 2, 3]
//     fresh: [4, 5, 6]
//   pieces: [90, 400, rest, whole]            # frames from every start in mid-air; from there to
//                                             # the end; whole flights
//   every: 20                                 # seconds from start to start [20]
//   recordings: [MH_01_easy_t05_t20]          # folders with pictures, beside or without motions
//   starts:                                   # in recordings: the first frame and the step,
//                                             # in sets
//     even: [0, 20]
//     odd: [10, 20]
//   disturbances: [none, noise=10]            # of all pieces (disturbance.h) [none]
//   seeds: [1, 2, 3]                          # of the workload's random draws [1, 2, 3]
//   size: 160x120                             # of the images [160x120]
//   variants:                                 # [next]
//     - { profile: next, workload.window: 8 }
//
// All faults are InputErrors with file, line, key and the nearest valid name.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/base/builtin_file.h"
#include "tools/app/cli/command_line.h"
#include "tools/app/record/statistic_list.h"
#include "tools/app/study/accuracy_study.h"
#include "tools/app/study/engine.h"
#include "tools/app/table/terminal_table.h"
#include "traces/datasets/dataset.h"
#include "traces/datasets/disturbance.h"
#include "traces/datasets/image_preparation.h"
#include "traces/synthesis/place.h"
#include "traces/trajectories/trajectory.h"
#include "workload/vio/parameters.h"

namespace leviosim::tools {

/// In place of a number of frames: from the first to the last.
inline constexpr std::size_t kWholeFlight = 0;
/// In place of a number of frames: from every start to the last frame, where that is longer than
/// all pieces of the plan that have a number.
inline constexpr std::size_t kRest = std::numeric_limits<std::size_t>::max();

/// The fewest of a piece: that can be aligned.
inline constexpr std::size_t kFewestFrames = 3;

/// "90 frames", "rest", "whole".
std::string length_text(std::size_t frames);

struct FlightSet {
  std::string name;                   ///< "fresh"
  std::vector<traces::Place> worlds;  ///< in which motions are drawn; none: recordings as they are
  std::size_t first = 0;              ///< frame of a recording at which its first piece begins
  std::size_t step = 1;               ///< frames from there to the next one

  bool recorded() const { return worlds.empty(); }
  /// "worlds 1, 2, 3", "frames 10, 30, ...".
  std::string text() const;
};

struct FlightVariant {
  std::string profile;
  std::vector<vio::Assignment> workload;  ///< parameters that differ from the profile's

  /// "next window=8".
  std::string name() const;
};

struct FlightPlan {
  std::string name;  ///< or file
  std::string text;
  std::vector<std::string> motions;
  std::vector<std::string> recordings;
  std::vector<FlightSet> sets;
  std::vector<std::size_t> lengths;               ///< of the pieces, in frames; kRest, kWholeFlight
  std::vector<traces::Disturbance> disturbances;  ///< of every piece; never empty
  double every_s = 20;
  std::vector<std::uint32_t> seeds{1, 2, 3};
  traces::ImageSize size{160, 120};
  std::vector<FlightVariant> variants;
};

/// plans/*.yaml as part of the program, sorted by name.
std::span<const base::BuiltinFile> builtin_flight_plans();

/// A plan of the program, or that of a file if the name has a slash or ends in .yaml.
/// @throws InputError
FlightPlan flight_plan_named(const std::string& name);
/// The same from its text. @param file  for messages
FlightPlan parse_flight_plan(const std::string& file, const std::string& text);

/// Refuses parameters that contradict each other, and variants that are the same. @throws
/// InputError that names the variant
void check_variants(const FlightPlan& plan);

// Where in a flight an odometry is started: every so many seconds, wherever the vehicle moves then.
// The rule looks at the truth and the clock only, so that no start is chosen for what comes of it.

/// A vehicle moves that is faster than this on average over the first second. [m/s] Ground truth of
/// a vehicle that stands jitters by millimetres.
inline constexpr double kLeastSpeed = 0.1;

struct Starts {
  std::vector<std::size_t> frames;  ///< numbers of the frames at which to start, rising
  std::size_t at_rest = 0;          ///< starts left out, since the vehicle does not move
};

/// The first frame after every full multiple of `every_s` since frame 0, but not frame 0, at which
/// a flight begins anyway.
/// @param stamps_ns  of the frames, rising; within the truth
Starts starts_in_motion(const std::vector<std::int64_t>& stamps_ns, const traces::Trajectory& truth,
                        double every_s);

/// Length of the true path between two times, along all its samples. [m]
double true_path_m(const traces::Trajectory& truth, std::int64_t begin_ns, std::int64_t end_ns);

/// The ranges as few as possible: in order, and those put together that overlap or touch.
std::vector<traces::FrameRange> merged(std::vector<traces::FrameRange> ranges);

/// Where a range lies in the row of all frames of merged ranges, one of which holds it.
traces::FrameRange within(const std::vector<traces::FrameRange>& merged,
                          const traces::FrameRange& range);

// A benchmark of flights: the pieces that a plan asks for, and the native runs over them. Worlds
// are rendered along recorded motions when a run needs them, each once, and only the frames of its
// pieces; they are kept in the user's cache (run/flight_cache.h). Runs that are finished need no
// pictures: they are found by what the pictures are made from.

/// A motion or recording of the plan, opened.
struct FlightMotion {
  Sequence sequence;  ///< of the whole flight; a motion's has no pictures
  bool recorded = false;
  std::vector<std::int64_t> stamps_ns;
  Starts starts{};  ///< of a motion
};

/// Frames of a flight in one world, or as they were recorded.
struct FlightPiece {
  std::size_t motion = 0;             ///< of the benchmark
  std::size_t set = 0;                ///< of the plan
  traces::Place world{};              ///< of a motion
  std::size_t disturbance = 0;        ///< of the plan
  std::size_t length = kWholeFlight;  ///< as in the plan
  traces::FrameRange frames;          ///< of the whole flight
  double start_s = 0;                 ///< from the first frame of the flight
  double path_m = 0;                  ///< of the truth
};

struct Benchmark {
  FlightPlan plan;
  std::vector<FlightMotion> motions;  ///< those of the plan, then its recordings
  std::vector<FlightPiece> pieces;    ///< by length, set, motion, world, start, then disturbance
  std::size_t too_late =
      0;  ///< starts in motion from which a length goes beyond the end of a flight
};

/// @param folder  holds an ASL folder for each motion and recording of the plan; images of motions
///                need not be there
/// @throws InputError naming the option or file
Benchmark make_benchmark(FlightPlan plan, const std::string& folder);

/// A run for each variant, piece and seed, in this order; its row is row_of(). The benchmark must
/// outlive them. Those of motions name no data yet.
std::vector<Point> benchmark_runs(const Benchmark& benchmark);
std::size_t row_of(const Benchmark& benchmark, std::size_t variant, std::size_t piece);

/// A line for each piece.
std::string list_text(const Benchmark& benchmark);

/// What is drawn of a motion in a world: the frames of all its pieces. Recordings are not drawn.
struct DrawnFlight {
  std::size_t motion = 0;
  traces::Place world{};
  std::vector<traces::FrameRange> frames;  ///< merged()
};
/// By motion, then world.
std::vector<DrawnFlight> drawn_flights(const Benchmark& benchmark);

/// Draws what runs need that are not finished, and tells them where it is.
/// @throws InputError, Interrupted
void draw_flights(const Benchmark& benchmark, const Measure& how, const RunnerOptions& options,
                  std::vector<Point>& runs);

// What a benchmark of flights comes to: runs condensed to pieces, pieces to rows. Worlds, starts
// and random draws are kept apart. A piece counts once, with the median of its seeds; a row has the
// median of its pieces, and says how far that would move with other pieces, and with other seeds.

/// ATE over the length of the true path; none if the run diverged. [%]
std::optional<double> error_percent(const RunOutcome& outcome);

/// Beyond it a run failed, whether it is lost or only wrong. [% of the path]
inline constexpr double kFailedPercent = 10;
/// Up to it a run is right. [%]
inline constexpr double kRightPercent = 3;
/// Beyond it nobody may call a run good. [%]
inline constexpr double kSilentPercent = 20;

/// What runs said of themselves at their end, against what they were. Runs that say nothing, for
/// their front end has no "health", do not count.
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

// The result of a benchmark of flights as text, Markdown and JSON.

/// A row for each variant, length, set and motion; below, what the figures are.
std::string benchmark_text(const Benchmark& benchmark, const BenchmarkResult& result,
                           int width = table_width());
/// The rows and the pieces.
Json benchmark_json(const Benchmark& benchmark, const BenchmarkResult& result);

// The files of a benchmark of flights: its runs and pieces as CSV, the manifest, and a page for a
// browser.

/// A row for each run. @param runs  benchmark_runs()
Table benchmark_runs_table(const Benchmark& benchmark, const std::vector<Point>& runs,
                           const std::vector<RunOutcome>& outcomes, const Measure& how);

/// The data of the page. @param runs  benchmark_runs_table()
Json benchmark_page(const Benchmark& benchmark, const BenchmarkResult& result, Table runs);

/// `leviosim benchmark-flights` (tools/commands/commands.h).
Command add_benchmark_flights_command(CLI::App& app, const Words& words);

}  // namespace leviosim::tools
