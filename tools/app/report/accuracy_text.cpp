#include "tools/app/report/accuracy_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <optional>

#include "tools/app/table/cell.h"
#include "tools/app/table/terminal_table.h"
#include "traces/trajectories/attitude_errors.h"

namespace leviosim::tools {
namespace {

using traces::ErrorSummary;
using traces::Evaluation;
using traces::RelativeErrors;

std::string table_of(const std::vector<RelativeErrors>& errors) {
  Table table({{"length"},
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
    std::vector<Cell> cells{fmt::format("{:g} m", e.length_m), fmt::format("{}", e.count)};
    const ErrorSummary& t = e.translation;
    const ErrorSummary& r = e.rotation_deg_per_m;
    for (const double value : {t.mean, t.median, t.rmse, t.max})
      cells.push_back(fmt::format("{:.3f}", value));
    for (const double value : {r.mean, r.median, r.rmse, r.max})
      cells.push_back(fmt::format("{:.4f}", value));
    table.add(std::move(cells));
  }
  return terminal_text(table);
}

}  // namespace

std::string ate_text(const Evaluation& evaluation) {
  const ErrorSummary& t = evaluation.translation;
  if (!(t.rmse < kDiverged_m))
    return fmt::format("ATE: {}\n     {}\n", kDiverged, evaluation.protocol);
  return fmt::format(
             "ATE: {} RMSE ({} mean, {} median, {} worst)\n"
             "{}     {}\n",
             metres(t.rmse, 3), metres_text(t.mean, 3), metres_text(t.median, 3),
             metres_text(t.max, 3),
             evaluation.located_rmse_m
                 ? fmt::format("     {} RMSE without the poses that are guesses\n",
                               metres(*evaluation.located_rmse_m, 3))
                 : "",
             evaluation.protocol) +
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

}  // namespace leviosim::tools
