#include "tools/app/study/finished_runs.h"

#include "sim/base/check.h"
#include "tools/app/study/accuracy_study.h"

namespace leviosim::tools {
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
                  {ate_head("error (ATE)"), [](R r) { return r.outcome.ate_m; }},
                  {{.key = "relative_length_m"}, [how](R) { return how.length_m; }},
                  {{.key = "relative_translation_mean_percent", .decimals = 9},
                   [](R r) { return r.outcome.relative_percent; }},
                  {{.key = "sub_trajectories"}, [](R r) { return r.outcome.sub_trajectories; }},
                  {{.key = "matched"}, [](R r) { return r.outcome.matched; }},
                  {completion_head(), [](R r) { return r.outcome.completion; }},
                  {{.title = "path", .key = "path_m", .decimals = 9, .unit = "m", .is_setup = true},
                   [](R r) { return r.outcome.path_m; }},
                  {{.title = "failure", .key = "failure"}, [](R r) { return r.outcome.failure; }}})
    columns.push_back(column);
  std::vector<FinishedRun> runs;
  for (std::size_t i = 0; i < points.size(); ++i) runs.push_back({points[i], outcomes[i]});
  return table_of(columns, runs);
}

}  // namespace leviosim::tools
