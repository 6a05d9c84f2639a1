// What studies of accuracy keep of a run: how far its trajectory lies from the truth, and of a
// closed loop on a chip what became of its frames and what it took.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/app/result/camera_figures.h"
#include "tools/app/study/point.h"
#include "tools/app/study/runner.h"
#include "tools/app/table/banded.h"
#include "tools/app/table/table.h"
#include "traces/trajectories/scale_windows.h"
#include "traces/trajectories/trajectory.h"
#include "traces/trajectories/trajectory_alignment.h"
#include "workload/vio/frame_facts.h"

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
  std::string failure;              ///< why there are no errors; empty if there are
  std::optional<double> ate_m;      ///< RMSE
  std::optional<double> located_m;  ///< the same without poses that are guesses, if some are
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

/// Of error_of() or a median of such, with so many decimals.
std::string error_text(const std::optional<double>& error, int decimals);

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

/// "SE3-aligned, relative errors over 40 m, …": how the errors of the plan are formed.
std::string measure_text(const Measure& how);

/// Heads of columns that tables of such runs share. @param title  for people
Head ate_head(const char* title);
Head completion_head();

}  // namespace leviosim::tools
