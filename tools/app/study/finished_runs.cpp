#include "tools/app/study/finished_runs.h"

#include <fmt/core.h>

#include "sim/base/check.h"
#include "sim/base/interruption.h"
#include "tools/app/run/run_request.h"
#include "tools/app/run/simulate.h"
#include "tools/app/study/accuracy_study.h"
#include "tools/app/study/batch_plan.h"

namespace leviosim::tools {
namespace {

RunOutcome compute(const Point& point, const Measure& how) {
  RunRequest request = point.request;
  request.evaluate = false;  // outcome_of() does, and takes note of what diverged
  const RunResult result = simulate(request, [](const Progress&) { throw_if_interrupted(); });
  return outcome_of(result, point.sequence->truth, how);
}

}  // namespace

std::vector<RunOutcome> run_outcomes(const std::vector<Point>& points, const Measure& how,
                                     const RunnerOptions& options) {
  std::vector<RunOutcome> outcomes(points.size());
  PointBatch batch;
  const platform::Schema schema;
  for (const Point& point : points) {
    throw_if_interrupted();
    batch.keys.push_back(run_key(point, how, schema));
  }
  batch.compute = [&](std::size_t i) { return record_of(compute(points[i], how)); };
  batch.take = [&](std::size_t i, const RunRecord& o) { outcomes[i] = run_outcome_of(o); };
  run_points(batch, options);
  return outcomes;
}

Table run_rows(const std::vector<Point>& points, const std::vector<RunOutcome>& outcomes,
               const Measure& how, RunColumns columns) {
  check_equal(points.size(), outcomes.size(), "an outcome per run");
  using R = const FinishedRun&;
  for (const RunColumns::value_type& column :
       RunColumns{{{.title = "motion", .key = "sequence", .is_setup = true},
                   [](R r) { return r.point.sequence->name; }},
                  {{.key = "folder"}, [](R r) { return r.point.sequence->folder; }},
                  {{.key = "width"}, [](R r) { return r.point.request.image_size.width; }},
                  {{.key = "height"}, [](R r) { return r.point.request.image_size.height; }},
                  {{.key = "profile"}, [](R r) { return r.point.request.profile; }},
                  {{.title = "seed", .key = "seed", .is_setup = true},
                   [](R r) { return r.point.request.seed; }},
                  {{.key = "frames"}, [](R r) { return r.outcome.frames; }},
                  {{.key = "alignment"}, [how](R) { return name_of(how.alignment); }},
                  {{.title = "error (ATE)", .key = "ate_rmse_m", .decimals = 9, .unit = "m"},
                   [](R r) { return r.outcome.ate_m; }},
                  {{.key = "relative_length_m"}, [how](R) { return how.length_m; }},
                  {{.key = "relative_translation_mean_percent", .decimals = 9},
                   [](R r) { return r.outcome.relative_percent; }},
                  {{.key = "sub_trajectories"}, [](R r) { return r.outcome.sub_trajectories; }},
                  {{.key = "matched"}, [](R r) { return r.outcome.matched; }},
                  {{.title = "completion",
                  .key = "completion",
                  .decimals = 9,
                  .unit = "%",
                  .scale = 100,
                  .more_is_better = true},
                   [](R r) { return r.outcome.completion; }},
                  {{.title = "path", .key = "path_m", .decimals = 9, .unit = "m", .is_setup = true},
                   [](R r) { return r.outcome.path_m; }},
                  {{.title = "failure", .key = "failure"}, [](R r) { return r.outcome.failure; }}})
    columns.push_back(column);
  std::vector<FinishedRun> runs;
  for (std::size_t i = 0; i < points.size(); ++i) runs.push_back({points[i], outcomes[i]});
  return table_of(columns, runs);
}

std::vector<RunOutcome> run_outcomes(const BatchPlan& plan, const std::vector<Point>& points) {
  return run_outcomes(points, plan.measure, plan.runner);
}

std::string measure_text(const Measure& how) {
  return fmt::format("{}-aligned RMSE; mean translation error of sub-trajectories of {:g} m",
                     name_of(how.alignment), how.length_m);
}

}  // namespace leviosim::tools
