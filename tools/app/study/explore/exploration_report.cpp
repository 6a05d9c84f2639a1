#include "tools/app/study/explore/exploration_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tools/app/report/text_table.h"

namespace leviosim::tools {
namespace {

std::string number(std::optional<double> value) {
  return value ? fmt::format("{:.9f}", *value) : std::string();
}

std::string cell(std::optional<double> value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : "diverged";
}

std::string set_text(const ExploredPoint& point) {
  std::vector<std::string> texts;
  for (const vio::Assignment& a : point.set)
    texts.push_back(a.text().substr(vio::kParameterPrefix.size()));
  return texts.empty() ? "as it is" : fmt::format("{}", fmt::join(texts, " "));
}

/// Values of the dimensions with this profile.
std::vector<std::string> dimension_cells(const std::vector<Dimension>& dimensions,
                                         const vio::Profile& profile) {
  std::vector<std::string> cells;
  for (const Dimension& d : dimensions)
    cells.push_back(d.parameter->needs_imu && !profile.use_imu
                        ? std::string()
                        : vio::value_text(*d.parameter, d.parameter->get(profile)));
  return cells;
}

TextTable best_table(const BatchPlan& plan, const std::vector<ExploredPoint>& explored) {
  constexpr auto kLeft = TextTable::Align::Left;
  TextTable table({{"profile", kLeft},
                   {"parameters of", kLeft},
                   {"point"},
                   {"absolute [m]"},
                   {fmt::format("relative, {:g} m [%]", plan.measure.length_m)},
                   {"set (workload.…)", kLeft}});
  const auto add = [&](const char* what, const std::string& profile, const ExploredPoint* point) {
    if (point == nullptr)
      table.add({profile, what, "–", "diverged", "diverged", "–"});
    else
      table.add({profile, what, fmt::format("{}", point->point), cell(point->mean_ate, 3),
                 cell(point->mean_relative, 2), set_text(*point)});
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

std::string best_markdown(const BatchPlan& plan, const std::vector<ExploredPoint>& explored) {
  return best_table(plan, explored).markdown() + '\n' + note(plan);
}

std::string points_csv(const std::vector<Dimension>& dimensions,
                       const std::vector<ExploredPoint>& explored) {
  std::string text = "point,profile";
  for (const Dimension& d : dimensions) text += fmt::format(",{}", d.parameter->name);
  text +=
      ",sequence,runs,failed,ate_median_m,ate_least_m,ate_greatest_m,relative_median_percent,"
      "relative_least_percent,relative_greatest_percent\n";
  for (const ExploredPoint& point : explored) {
    vio::Profile profile = vio::profile_named(point.profile, 1);
    vio::set_parameters(point.set, profile);
    const std::vector<std::string> cells = dimension_cells(dimensions, profile);
    for (const ExploredPoint::OfSequence& s : point.sequences)
      text +=
          fmt::format("{},{},{},{},{},{},{},{},{},{},{},{}\n", point.point, point.profile,
                      fmt::join(cells, ","), s.sequence, s.ate.runs, s.ate.failed,
                      number(s.ate.median), number(s.ate.low), number(s.ate.high),
                      number(s.relative.median), number(s.relative.low), number(s.relative.high));
  }
  return text;
}

LeadingColumns point_columns(const std::vector<Dimension>& dimensions,
                             const ExplorationRuns& runs) {
  LeadingColumns columns{{"point"}, {}};
  for (const Dimension& d : dimensions) columns.names.emplace_back(d.parameter->name);
  for (std::size_t i = 0; i < runs.runs.size(); ++i) {
    std::vector<std::string> cells = dimension_cells(dimensions, profile_of(runs.runs[i].request));
    cells.insert(cells.begin(), fmt::format("{}", runs.point[i]));
    columns.cells.push_back(std::move(cells));
  }
  return columns;
}

}  // namespace leviosim::tools
