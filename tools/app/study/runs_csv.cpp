#include "tools/app/study/runs_csv.h"

#include "sim/base/check.h"
#include "tools/app/study/sequence.h"

namespace leviosim::tools {

std::string runs_csv(const std::vector<Point>& points, const std::vector<RunOutcome>& outcomes,
                     const Measure& how, const std::function<CsvRow(const Point&)>& leading) {
  check_equal(points.size(), outcomes.size(), "an outcome per run");
  std::vector<CsvRow> rows;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const RunRequest& run = points[i].request;
    const RunOutcome& o = outcomes[i];
    CsvRow& row = rows.emplace_back(leading ? leading(points[i]) : CsvRow());
    row.insert(row.end(),
               {Cell("sequence", plain_cell(points[i].sequence->name)),
                Cell("folder", plain_cell(points[i].sequence->folder)),
                Cell("width", run.image_size.width), Cell("height", run.image_size.height),
                Cell("profile", run.profile), Cell("seed", run.seed), Cell("frames", o.frames),
                Cell("alignment", name_of(how.alignment)), Cell("ate_rmse_m", decimals(o.ate_m, 9)),
                Cell("relative_length_m", fmt::format("{:g}", how.length_m)),
                Cell("relative_translation_mean_percent", decimals(o.relative_percent, 9)),
                Cell("sub_trajectories", o.sub_trajectories), Cell("matched", o.matched),
                Cell("completion", decimals(o.completion, 9)),
                Cell("path_m", decimals(o.path_m, 9)), Cell("failure", plain_cell(o.failure))});
  }
  return csv_text(rows);
}

}  // namespace leviosim::tools
