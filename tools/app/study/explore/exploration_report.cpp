#include "tools/app/study/explore/exploration_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

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

/// Values of the dimensions with this profile.
void add_dimensions(const std::vector<Dimension>& dimensions, const vio::Profile& profile,
                    CsvRow& row) {
  for (const Dimension& d : dimensions)
    row.push_back(Cell(std::string(d.parameter->name),
                       d.parameter->needs_imu && !profile.use_imu
                           ? std::string()
                           : vio::value_text(*d.parameter, d.parameter->get(profile))));
}

/// "ate_median_m".
void add_spread(const std::string& figure, const std::string& unit, const Spread& spread,
                CsvRow& row) {
  row.insert(row.end(), {Cell(figure + "_median_" + unit, decimals(spread.median, 9)),
                         Cell(figure + "_least_" + unit, decimals(spread.low, 9)),
                         Cell(figure + "_greatest_" + unit, decimals(spread.high, 9))});
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
      table.add({profile, what, "–", kDiverged, kDiverged, "–"});
    else
      table.add({profile, what, fmt::format("{}", point->point),
                 decimals(point->mean_ate, 3, kDiverged),
                 decimals(point->mean_relative, 2, kDiverged), set_text(*point)});
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
  std::vector<CsvRow> rows;
  for (const ExploredPoint& point : explored) {
    vio::Profile profile = vio::profile_named(point.profile, 1);
    vio::set_parameters(point.set, profile);
    for (const ExploredPoint::OfSequence& s : point.sequences) {
      CsvRow& row =
          rows.emplace_back(CsvRow{Cell("point", point.point), Cell("profile", point.profile)});
      add_dimensions(dimensions, profile, row);
      row.insert(row.end(), {Cell("sequence", s.sequence), Cell("runs", s.ate.runs),
                             Cell("failed", s.ate.failed)});
      add_spread("ate", "m", s.ate, row);
      add_spread("relative", "percent", s.relative, row);
    }
  }
  return csv_text(rows);
}

CsvRow point_cells(const BatchPlan& plan, const std::vector<Dimension>& dimensions,
                   const Point& run) {
  CsvRow row{Cell("point", point_of_row(plan, run.row))};
  add_dimensions(dimensions, profile_of(run.request), row);
  return row;
}

}  // namespace leviosim::tools
