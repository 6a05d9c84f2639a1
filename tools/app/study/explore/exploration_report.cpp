#include "tools/app/study/explore/exploration_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tools/app/report/number_text.h"
#include "tools/app/report/text_table.h"

namespace leviosim::tools {
namespace {

constexpr const char* kDiverged = "diverged";

std::string set_text(const ExploredPoint& point) {
  std::vector<std::string> texts;
  for (const vio::Assignment& a : point.set)
    texts.push_back(a.text().substr(vio::kParameterPrefix.size()));
  return texts.empty() ? "as it is" : fmt::format("{}", fmt::join(texts, " "));
}

std::string error_text(std::optional<double> error, int decimals) {
  return figure_text(error, decimals, kDiverged);
}

/// The value of a dimension with this profile.
std::string value_of(const Dimension& d, const vio::Profile& profile) {
  return d.parameter->needs_imu && !profile.use_imu
             ? std::string()
             : vio::value_text(*d.parameter, d.parameter->get(profile));
}

TextTable best_table(const BatchPlan& plan, const std::vector<ExploredPoint>& explored) {
  TextTable table({{"profile", kLeft},
                   {"parameters of", kLeft},
                   {"point"},
                   {"absolute [m]"},
                   {fmt::format("relative, {:g} m [%]", plan.measure.length_m)},
                   {"set (workload.…)", kLeft}});
  const auto add = [&](const char* what, const std::string& profile, const ExploredPoint* point) {
    if (point == nullptr)
      table.add({profile, what, "–", kDiverged, kDiverged, "–"});
    else
      table.add({profile, what, fmt::format("{}", point->point), error_text(point->mean_ate, 3),
                 error_text(point->mean_relative, 2), set_text(*point)});
  };
  for (const std::string& profile : plan.profiles) {
    for (const ExploredPoint& point : explored)
      if (point.point == 0 && point.profile == profile) add("the profile", profile, &point);
    add("least absolute error", profile, best_of(explored, profile, &ExploredPoint::mean_ate));
    add("least relative error", profile, best_of(explored, profile, &ExploredPoint::mean_relative));
  }
  return table;
}

std::string note(const BatchPlan& plan) {
  return fmt::format(
      "{}. Means over {} of medians over {} and folders\n", measure_text(plan.measure),
      fmt::join(sequence_names(plan), ", "),
      plan.seeds.size() == 1 ? "1 seed" : fmt::format("{} seeds", plan.seeds.size()));
}

}  // namespace

std::string best_text(const BatchPlan& plan, const std::vector<ExploredPoint>& explored) {
  return best_table(plan, explored).str() + "  " + note(plan);
}

std::string exploration_conclusion(const BatchPlan& plan,
                                   const std::vector<ExploredPoint>& explored) {
  const std::string& profile = plan.profiles.front();
  const ExploredPoint* best = best_of(explored, profile, &ExploredPoint::mean_ate);
  if (best == nullptr) return fmt::format("verdict: {} diverged at all points", profile);
  std::string text = fmt::format("in short: {} has its least absolute error, {} m, at point {}",
                                 profile, error_text(best->mean_ate, 3), best->point);
  for (const ExploredPoint& point : explored)
    if (point.point == 0 && point.profile == profile)
      text += fmt::format("; as it is, {} m", error_text(point.mean_ate, 3));
  return text;
}

std::string best_markdown(const BatchPlan& plan, const std::vector<ExploredPoint>& explored) {
  return best_table(plan, explored).markdown() + '\n' + note(plan);
}

std::string points_csv(const std::vector<Dimension>& dimensions,
                       const std::vector<ExploredPoint>& explored) {
  struct Row {
    const ExploredPoint& point;
    const ExploredPoint::OfSequence& at;
    const vio::Profile& profile;
  };
  using R = const Row&;
  base::CsvTable<Row> table{{"point", [](R r) { return r.point.point; }},
                            {"profile", [](R r) { return r.point.profile; }}};
  for (const Dimension& d : dimensions)
    table.add(std::string(d.parameter->name), [&d](R r) { return value_of(d, r.profile); });
  table.add("sequence", [](R r) { return r.at.sequence; });
  table.add("runs", [](R r) { return r.at.ate.runs; });
  table.add("failed", [](R r) { return r.at.ate.failed; });
  const auto add_spread = [&](const std::string& name, const std::string& unit, auto figure) {
    const auto add = [&](const char* part, auto of) {
      table.add(name + part + unit, [=](R r) { return base::fixed(r.at.*figure.*of, 9); });
    };
    add("_median_", &Spread::median);
    add("_least_", &Spread::low);
    add("_greatest_", &Spread::high);
  };
  add_spread("ate", "m", &ExploredPoint::OfSequence::ate);
  add_spread("relative", "percent", &ExploredPoint::OfSequence::relative);
  std::string text = table.header();
  for (const ExploredPoint& point : explored) {
    vio::Profile profile = vio::profile_named(point.profile, 1);
    vio::set_parameters(point.set, profile);
    for (const ExploredPoint::OfSequence& at : point.sequences)
      text += table.line({point, at, profile});
  }
  return text;
}

RunColumns point_columns(const BatchPlan& plan, const std::vector<Dimension>& dimensions) {
  using R = const FinishedRun&;
  RunColumns columns{{"point", [&plan](R r) { return point_of_row(plan, r.point.row); }}};
  for (const Dimension& d : dimensions)
    columns.add(std::string(d.parameter->name),
                [&d](R r) { return value_of(d, profile_of(r.point.request)); });
  return columns;
}

}  // namespace leviosim::tools
