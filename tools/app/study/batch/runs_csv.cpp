#include "tools/app/study/batch/runs_csv.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "sim/base/check.h"

namespace leviosim::tools {
namespace {

std::string number(std::optional<double> value) {
  return value ? fmt::format("{:.9f}", *value) : std::string();
}

std::string row(const BatchRun& run, const RunOutcome& outcome, const Measure& how) {
  const RunRequest& r = run.request;
  const std::vector<std::string> cells{csv_cell(run.sequence->name),
                                       csv_cell(run.sequence->folder),
                                       fmt::format("{}", r.image_size.width),
                                       fmt::format("{}", r.image_size.height),
                                       r.profile,
                                       fmt::format("{}", r.seed),
                                       fmt::format("{}", outcome.frames),
                                       std::string(name_of(how.alignment)),
                                       number(outcome.ate_m),
                                       fmt::format("{:g}", how.length_m),
                                       number(outcome.relative_percent),
                                       fmt::format("{}", outcome.sub_trajectories),
                                       fmt::format("{}", outcome.matched),
                                       number(outcome.completion),
                                       number(outcome.path_m),
                                       csv_cell(outcome.failure)};
  return fmt::format("{}\n", fmt::join(cells, ","));
}

}  // namespace

std::string csv_cell(std::string text) {
  std::replace_if(
      text.begin(), text.end(),
      [](char c) { return c == ',' || c == '"' || c == '\n' || c == '\r'; }, ' ');
  return text;
}

std::string runs_csv(const std::vector<BatchRun>& runs, const std::vector<RunOutcome>& outcomes,
                     const Measure& how, const LeadingColumns& leading) {
  check_equal(runs.size(), outcomes.size(), "an outcome per run");
  const auto before = [](const std::vector<std::string>& cells) {
    return cells.empty() ? std::string() : fmt::format("{},", fmt::join(cells, ","));
  };
  std::string text =
      before(leading.names) +
      "sequence,folder,width,height,profile,seed,frames,alignment,ate_rmse_m,relative_length_m,"
      "relative_translation_mean_percent,sub_trajectories,matched,completion,path_m,failure\n";
  for (std::size_t i = 0; i < runs.size(); ++i)
    text += (leading.names.empty() ? std::string() : before(leading.cells.at(i))) +
            row(runs[i], outcomes[i], how);
  return text;
}

}  // namespace leviosim::tools
