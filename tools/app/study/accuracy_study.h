// What studies of accuracy keep of a run: how far its trajectory lies from the truth, and of a
// closed loop on a chip what became of its frames and what it took.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/base/csv.h"
#include "sim/outputs/output_folder.h"
#include "tools/app/cli/command_line.h"
#include "tools/app/record/statistic_list.h"
#include "tools/app/result/summary.h"
#include "tools/app/study/engine.h"
#include "tools/app/table/banded.h"
#include "tools/app/table/table_files.h"
#include "traces/trajectories/evaluation.h"
#include "traces/trajectories/trajectory.h"
#include "traces/trajectories/trajectory_errors.h"
#include "workload/vio/frame_facts.h"

namespace CLI {
class App;
}

namespace leviosim::tools {

/// How trajectories are compared with the truth.
struct Measure {
  traces::Alignment alignment = traces::Alignment::se3;
  double length_m = 40;  ///< of the sub-trajectories of relative errors
};

/// Of a closed loop on a chip.
struct LoopOutcome {
  CameraFigures camera;
  std::optional<Banded> power_w;  ///< mean over all of the time; none if the chip has no energies
  std::optional<Banded> frame_j;  ///< per processed frame, idle time included
};

using vio::Health;

struct RunOutcome {
  std::string failure;          ///< why there are no errors; empty if there are
  std::optional<double> ate_m;  ///< RMSE
  std::optional<double>
      relative_percent;  ///< mean translation error; none if the path is too short
  std::size_t sub_trajectories = 0;
  std::size_t frames = 0;  ///< that the estimate ought to have
  std::size_t matched = 0;
  double completion = 0;
  std::size_t map_restarts = 0;
  std::optional<Health> health;       ///< at the last frame; none if none was processed
  traces::ScaleSummary scale;         ///< of the estimate over the truth
  std::optional<double> end_drift_m;  ///< traces::end_drift(); none if the path is too short
  double path_m = 0;                  ///< of the truth
  std::string protocol;               ///< traces::Evaluation::protocol
  std::optional<LoopOutcome> loop;
};

/// @param expected  poses that a complete estimate has
/// @throws InputError for data that cannot be compared at all; an estimate that cannot is a failure
RunOutcome measure(const traces::Trajectory& estimate, const traces::Trajectory& truth,
                   const Measure& how, std::size_t expected);
/// Of an estimate that is complete.
RunOutcome measure(const traces::Trajectory& estimate, const traces::Trajectory& truth,
                   const Measure& how);
/// All of a run, which was not evaluated.
RunOutcome outcome_of(const RunResult& run, const traces::Trajectory& truth, const Measure& how);

/// The error of the run; none if it diverged: it has no error, or one above the length of the path.
std::optional<double> error_of(const RunOutcome& outcome);

inline constexpr const char* kDiverged = "diverged";
/// Of error_of() or a median of such, with so many decimals.
std::string error_text(const std::optional<double>& error, int decimals);
/// rounded(); null for nothing.
Json figure_json(const std::optional<double>& figure);

/// As it is kept, and back.
RunRecord record_of(const RunOutcome& outcome);
RunOutcome run_outcome_of(const RunRecord& record);

/// What the outcome of a run is kept under.
std::string run_key(const Point& point, const Measure& how, const platform::Schema& schema);

/// Runs the points, each of which has a sequence. @returns outcomes in their order
/// @throws InputError for data that cannot be used, Interrupted
std::vector<RunOutcome> run_outcomes(const std::vector<Point>& points, const Measure& how,
                                     const RunnerOptions& options);

/// The outcomes of each row of a study's table, in the order of the points.
std::vector<std::vector<RunOutcome>> by_row(const std::vector<Point>& points,
                                            const std::vector<RunOutcome>& outcomes,
                                            std::size_t rows);

// The runs of a study of accuracy as a tidy table: a row per run.

struct FinishedRun {
  const Point& point;
  const RunOutcome& outcome;
};
using RunColumns = Columns<FinishedRun>;

/// @param columns  those before the others, such as the values of a sweep
Table run_rows(const std::vector<Point>& points, const std::vector<RunOutcome>& outcomes,
               const Measure& how, RunColumns columns = {});

// What studies of accuracy have in common, which make native runs of many profiles, image sizes and
// seeds over sequences: options, points, the manifest.

/// As typed.
struct BatchWords {
  std::vector<std::string> data;
  std::vector<std::string> profiles{"levio", "levio-no-imu", "levio-no-imu-no-epnp"};
  std::vector<std::string> sizes{"160x120"};
  std::vector<std::string> seeds{"1", "2", "3"};
  std::vector<std::string> overrides;
  std::string frames;
  std::string align = "se3";
  std::string relative = "40";
  RunnerWords runner;
  std::string out;
  bool force = false;
  bool quiet = false;
  bool json = false;
};

/// Checked, and the sequences opened.
struct BatchPlan {
  std::vector<Sequence> sequences;
  std::vector<std::string> profiles;
  std::vector<traces::ImageSize> sizes;
  std::vector<std::uint32_t> seeds;
  std::vector<vio::Assignment> workload;  ///< of every run
  std::optional<traces::FrameRange> frames;
  Measure measure;
  std::shared_ptr<outputs::OutputFolder> out;  ///< for the results
  RunnerOptions runner;
};

/// What --seed, --profile and -p of native runs were given. @throws InputError naming the option
std::vector<std::uint32_t> batch_seeds(const std::vector<std::string>& words);
std::vector<std::string> known_profiles(const std::vector<std::string>& words);
std::vector<vio::Assignment> native_workload(const std::vector<std::string>& overrides);

void add_batch_options(CLI::App& command, BatchWords& words);

/// @throws InputError naming the option
BatchPlan make_plan(const CLI::App& command, const BatchWords& words);

/// A run of the plan; its sequence must outlive it.
Point make_run(const BatchPlan& plan, const Sequence& sequence, const std::string& profile,
               const traces::ImageSize& size, std::uint32_t seed);

/// run_outcomes() as the plan says.
std::vector<RunOutcome> run_outcomes(const BatchPlan& plan, const std::vector<Point>& points);

/// Names of the sequences, each once, in the order in which they were given.
std::vector<std::string> sequence_names(const BatchPlan& plan);

/// What every manifest of a study begins with. @param format  "leviosim batch manifest"
Json study_manifest(const std::string& format, const Words& command_line);

/// The content of manifest.json. Nothing in it depends on the host or on cache hits.
Json batch_manifest(const BatchPlan& plan, const Words& command_line);

/// A command line to try next: the first of the sequences on a chip.
std::vector<std::string> after_batch(const BatchPlan& plan);

/// "SE3-aligned, relative errors over 40 m, …": how the errors of the plan are formed.
std::string measure_text(const Measure& how);

/// "752x480".
std::string size_text(const traces::ImageSize& size);

}  // namespace leviosim::tools
