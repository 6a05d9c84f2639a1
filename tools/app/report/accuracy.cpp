#include "tools/app/report/accuracy.h"

#include <fmt/format.h>

#include <array>

#include "tools/app/report/text_table.h"
#include "traces/trajectories/trajectory_errors.h"

namespace leviosim::tools {
namespace {

using traces::ErrorSummary;
using traces::Evaluation;
using traces::RelativeErrors;

std::string relative_protocol(const Evaluation& evaluation) {
  return "from every matched pose to the first that is the length farther along the true path; " +
         evaluation.protocol;
}

std::string table_of(const std::vector<RelativeErrors>& errors) {
  TextTable table({{"length"},
                   {"number"},
                   {"translation %: mean"},
                   {"median"},
                   {"RMSE"},
                   {"worst"},
                   {"rotation deg/m: mean"},
                   {"median"},
                   {"RMSE"},
                   {"worst"}});
  for (const RelativeErrors& e : errors) {
    std::vector<std::string> cells{fmt::format("{:g} m", e.length_m), fmt::format("{}", e.count)};
    const ErrorSummary& t = e.translation;
    const ErrorSummary& r = e.rotation_deg_per_m;
    for (const double value : {t.mean, t.median, t.rmse, t.max})
      cells.push_back(fmt::format("{:.3f}", value));
    for (const double value : {r.mean, r.median, r.rmse, r.max})
      cells.push_back(fmt::format("{:.4f}", value));
    table.add(std::move(cells));
  }
  return table.str();
}

}  // namespace

std::string ate_text(const Evaluation& evaluation) {
  const ErrorSummary& t = evaluation.translation;
  return fmt::format(
             "ATE: {:.3f} m RMSE ({:.3f} mean, {:.3f} median, {:.3f} worst)\n"
             "     {}\n",
             t.rmse, t.mean, t.median, t.max, evaluation.protocol) +
         attitude_text(evaluation);
}

std::string attitude_text(const Evaluation& evaluation) {
  const std::optional<traces::AttitudeErrors> errors = attitude_errors(evaluation);
  if (!errors) return {};
  std::string text = fmt::format("attitude: tilt {:.2f}° RMSE, heading {:.2f}° RMSE, best aligned",
                                 errors->tilt_rmse_deg, errors->heading_rmse_deg);
  if (!errors->is_gravity_aligned())
    text += fmt::format("\n     not gravity-aligned: its vertical is {:.1f}° off the true one",
                        errors->world_tilt_deg);
  return text + '\n';
}

std::string relative_text(const Evaluation& evaluation, const std::vector<RelativeErrors>& errors) {
  std::vector<RelativeErrors> rows;
  std::vector<std::string> too_long;
  for (const RelativeErrors& e : errors) {
    if (e.count > 0)
      rows.push_back(e);
    else
      too_long.push_back(fmt::format("{:g} m", e.length_m));
  }
  std::string text;
  if (!rows.empty())
    text += fmt::format("relative errors over sub-trajectories\n{}  {}\n", table_of(rows),
                        relative_protocol(evaluation));
  if (!too_long.empty())
    text += fmt::format("no relative errors over {}: too long for {:.2f} m of path\n",
                        fmt::join(too_long, ", "), evaluation.path_length_m);
  return text;
}

void add_ate(StatisticList& list, const Evaluation& evaluation,
             const std::optional<traces::AttitudeErrors>& attitude) {
  const auto add = [&](const char* name, const char* unit, const char* description, Json value) {
    list.add_with_protocol(std::string("accuracy.") + name, unit, description, std::move(value),
                           evaluation.protocol);
  };
  const ErrorSummary& t = evaluation.translation;
  add("ate.rmse", "m", "absolute trajectory error, root mean square", rounded(t.rmse));
  add("ate.mean", "m", "absolute trajectory error, mean", rounded(t.mean));
  add("ate.median", "m", "absolute trajectory error, median", rounded(t.median));
  add("ate.worst", "m", "absolute trajectory error, worst", rounded(t.max));
  if (attitude) {
    add("tilt.rmse", "deg", "of the vertical, attitudes best aligned, root mean square",
        rounded(attitude->tilt_rmse_deg));
    add("heading.rmse", "deg", "about the vertical, attitudes best aligned, root mean square",
        rounded(attitude->heading_rmse_deg));
  }
  add("matched", "1", "poses matched with the ground truth", evaluation.matched);
  add("completion", "1", "how much of the flight has an estimate", rounded(evaluation.completion));
  add("truth_length", "m", "of the true path", rounded(evaluation.path_length_m));
}

void add_relative(StatisticList& list, const Evaluation& evaluation, const RelativeErrors& errors) {
  const std::string path = fmt::format("accuracy.relative.{:g}m.", errors.length_m);
  const std::string protocol = relative_protocol(evaluation);
  list.add_with_protocol(path + "count", "1", "sub-trajectories of this length", errors.count,
                         protocol);
  const auto add = [&](const std::string& kind, const char* unit, const ErrorSummary& summary) {
    struct Figure {
      const char* name;
      const char* description;
      double value;
    };
    for (const Figure& f :
         {Figure{"rmse", "root mean square", summary.rmse}, Figure{"mean", "mean", summary.mean},
          Figure{"median", "median", summary.median}, Figure{"worst", "worst", summary.max}})
      list.add_with_protocol(path + kind + '.' + f.name, unit,
                             "relative " + kind + " error, " + f.description,
                             errors.count > 0 ? rounded(f.value) : Json(nullptr), protocol);
  };
  add("translation", "%", errors.translation);
  add("rotation", "deg/m", errors.rotation_deg_per_m);
}

}  // namespace leviosim::tools
