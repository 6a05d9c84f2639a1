#include "tools/app/study/runs_csv.h"

#include <fmt/core.h>

#include <algorithm>

#include "sim/base/check.h"
#include "tools/app/study/sequence.h"

namespace leviosim::tools {

std::string plain_cell(std::string text) {
  std::replace_if(
      text.begin(), text.end(),
      [](char c) { return c == ',' || c == '"' || c == '\n' || c == '\r'; }, ' ');
  return text;
}

std::string runs_csv(const std::vector<Point>& points, const std::vector<RunOutcome>& outcomes,
                     const Measure& how, RunColumns columns) {
  check_equal(points.size(), outcomes.size(), "an outcome per run");
  using Run = const FinishedRun&;
  using base::fixed;
  const auto add_of_point = [&](const char* name, auto of) {
    columns.add(name, [of](Run r) { return base::Cell(of(r.point, r.point.request)); });
  };
  const auto add = [&](const char* name, auto of) {
    columns.add(name, [of](Run r) { return base::Cell(of(r.outcome)); });
  };
  using P = const Point&;
  using R = const RunRequest&;
  using O = const RunOutcome&;
  add_of_point("sequence", [](P p, R) { return plain_cell(p.sequence->name); });
  add_of_point("folder", [](P p, R) { return plain_cell(p.sequence->folder); });
  add_of_point("width", [](P, R r) { return r.image_size.width; });
  add_of_point("height", [](P, R r) { return r.image_size.height; });
  add_of_point("profile", [](P, R r) { return r.profile; });
  add_of_point("seed", [](P, R r) { return r.seed; });
  add("frames", [](O o) { return o.frames; });
  add("alignment", [how](O) { return name_of(how.alignment); });
  add("ate_rmse_m", [](O o) { return fixed(o.ate_m, 9); });
  add("relative_length_m", [how](O) { return fmt::format("{:g}", how.length_m); });
  add("relative_translation_mean_percent", [](O o) { return fixed(o.relative_percent, 9); });
  add("sub_trajectories", [](O o) { return o.sub_trajectories; });
  add("matched", [](O o) { return o.matched; });
  add("completion", [](O o) { return fixed(o.completion, 9); });
  add("path_m", [](O o) { return fixed(o.path_m, 9); });
  add("failure", [](O o) { return plain_cell(o.failure); });
  std::vector<FinishedRun> runs;
  for (std::size_t i = 0; i < points.size(); ++i) runs.push_back({points[i], outcomes[i]});
  return columns.text(runs);
}

}  // namespace leviosim::tools
