#include "tools/app/study/explore/exploration.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <limits>
#include <memory>

#include "sim/base/check.h"
#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "sim/base/interruption.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/cli/printout.h"
#include "tools/app/cli/version.h"
#include "tools/app/html_report/report_option.h"
#include "tools/app/html_report/study_page.h"
#include "tools/app/record/statistic_list.h"
#include "tools/app/run/workload.h"
#include "tools/app/run/workload_options.h"
#include "tools/app/study/accuracy_study.h"
#include "tools/app/study/batch_plan.h"
#include "tools/app/study/finished_runs.h"
#include "tools/app/study/sweep/key_domain.h"
#include "tools/app/study/sweep/points.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {
namespace {

/// Rows are by point, profile, then sequence_names().
std::vector<Point> exploration_runs(const BatchPlan& plan, const ExplorationPoints& points) {
  const std::vector<std::string> names = sequence_names(plan);
  std::vector<Point> runs;
  std::size_t first_row = 0;
  for (const std::vector<vio::Assignment>& point : points)
    for (const std::string& profile : plan.profiles) {
      throw_if_interrupted();
      const std::vector<vio::Assignment> set = effective(point, profile);
      for (const Sequence& sequence : plan.sequences)
        for (const std::uint32_t seed : plan.seeds) {
          Point run = make_run(plan, sequence, profile, plan.sizes.front(), seed);
          run.request.workload.insert(run.request.workload.end(), set.begin(), set.end());
          run.row =
              first_row + static_cast<std::size_t>(
                              std::find(names.begin(), names.end(), sequence.name) - names.begin());
          runs.push_back(std::move(run));
        }
      first_row += names.size();
    }
  return runs;
}

/// The point of a row.
std::size_t point_of_row(const BatchPlan& plan, std::size_t row) {
  return row / (plan.profiles.size() * sequence_names(plan).size());
}

RunRequest request_of(const std::string& profile, const std::vector<vio::Assignment>& set) {
  RunRequest request;
  request.profile = profile;
  request.workload = set;
  return request;
}

/// The value of a dimension in a run; empty where the profile has no use for it.
std::string value_of(const Dimension& d, const RunRequest& request) {
  return d.parameter->needs_imu && !vio::uses_imu(request.profile)
             ? std::string()
             : vio::value_text(*d.parameter, value_of(request, *d.parameter));
}

/// By point, then profile. @param runs  exploration_runs()
std::vector<ExploredPoint> explored_points(const BatchPlan& plan,
                                           const std::vector<Dimension>& dimensions,
                                           const ExplorationPoints& points,
                                           const std::vector<Point>& runs,
                                           const std::vector<RunOutcome>& outcomes) {
  using OfSequence = ExploredPoint::OfSequence;
  const std::vector<std::string> names = sequence_names(plan);
  const auto rows = by_row(runs, outcomes, points.size() * plan.profiles.size() * names.size());
  auto row = rows.begin();
  std::vector<ExploredPoint> explored;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (const std::string& profile : plan.profiles) {
      ExploredPoint point{i, profile, effective(points[i], profile), {}, {}, {}, {}};
      const RunRequest request = request_of(profile, point.set);
      for (const Dimension& d : dimensions) point.values.push_back(value_of(d, request));
      for (const std::string& name : names) {
        point.sequences.push_back({name, spread_of(values_of(*row, &RunOutcome::ate_m)),
                                   spread_of(values_of(*row, &RunOutcome::relative_percent))});
        ++row;
      }
      point.mean_ate =
          mean_of(values_of(point.sequences, [](const OfSequence& s) { return s.ate.median; }));
      point.mean_relative = mean_of(
          values_of(point.sequences, [](const OfSequence& s) { return s.relative.median; }));
      explored.push_back(std::move(point));
    }
  return explored;
}

/// The best of a profile by a mean; nullptr if all diverged. The earlier one of equals.
const ExploredPoint* best_of(const std::vector<ExploredPoint>& explored, const std::string& profile,
                             std::optional<double> ExploredPoint::*by) {
  const ExploredPoint* best = nullptr;
  for (const ExploredPoint& point : explored)
    if (point.profile == profile && point.*by && (best == nullptr || *(point.*by) < *(best->*by)))
      best = &point;
  return best;
}

std::string set_text(const ExploredPoint& point) {
  std::vector<std::string> texts;
  for (const vio::Assignment& a : point.set)
    texts.push_back(a.text().substr(vio::kParameterPrefix.size()));
  return texts.empty() ? "as it is" : fmt::format("{}", fmt::join(texts, " "));
}

Table best_table(const BatchPlan& plan, const std::vector<ExploredPoint>& explored) {
  Table table({{"profile", kLeft},
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

/// "levio has its least absolute error, 0.051 m, at point 3; as it is, 0.060 m"; nothing if it
/// diverged at all points.
std::string gain_text(const std::string& profile, const std::vector<ExploredPoint>& explored) {
  const ExploredPoint* best = best_of(explored, profile, &ExploredPoint::mean_ate);
  if (best == nullptr) return {};
  std::string text = fmt::format("{} has its least absolute error, {} m, at point {}", profile,
                                 error_text(best->mean_ate, 3), best->point);
  for (const ExploredPoint& point : explored)
    if (point.point == 0 && point.profile == profile)
      text += fmt::format("; as it is, {} m", error_text(point.mean_ate, 3));
  return text;
}

/// Per profile: as it is, the point of least absolute error, and that of least relative error.
std::string best_text(const BatchPlan& plan, const std::vector<ExploredPoint>& explored) {
  return terminal_text(best_table(plan, explored)) + "  " + note(plan);
}

/// What the first profile gains by its best point, in a sentence.
std::string exploration_conclusion(const BatchPlan& plan,
                                   const std::vector<ExploredPoint>& explored) {
  const std::string gain = gain_text(plan.profiles.front(), explored);
  return gain.empty() ? fmt::format("verdict: {} diverged at all points", plan.profiles.front())
                      : "in short: " + gain;
}

std::string best_markdown(const BatchPlan& plan, const std::vector<ExploredPoint>& explored) {
  return markdown_table(best_table(plan, explored)) + '\n' + note(plan);
}

/// A point over a sequence.
struct PointRow {
  const ExploredPoint& point;
  const ExploredPoint::OfSequence& at;
};

std::vector<PointRow> point_rows(const std::vector<ExploredPoint>& explored) {
  std::vector<PointRow> rows;
  for (const ExploredPoint& point : explored)
    for (const ExploredPoint::OfSequence& at : point.sequences) rows.push_back({point, at});
  return rows;
}

Table points_table(const BatchPlan& plan, const std::vector<Dimension>& dimensions,
                   const std::vector<ExploredPoint>& explored) {
  using R = const PointRow&;
  Columns<PointRow> columns{
      {{.title = "point", .key = "point", .is_setup = true}, [](R r) { return r.point.point; }},
      {{.title = "profile", .key = "profile", .is_setup = true},
       [](R r) { return r.point.profile; }}};
  for (std::size_t i = 0; i < dimensions.size(); ++i) {
    const vio::Parameter& parameter = *dimensions[i].parameter;
    columns.push_back({{.title = std::string(parameter.name.substr(vio::kParameterPrefix.size())),
                        .key = std::string(parameter.name),
                        .unit = std::string(parameter.unit),
                        .is_setup = true},
                       [i](R r) { return spelled(r.point.values[i]); }});
  }
  columns.push_back({{.title = "sequence", .key = "sequence", .is_setup = true},
                     [](R r) { return r.at.sequence; }});
  columns.push_back({{.key = "runs"}, [](R r) { return r.at.ate.runs; }});
  columns.push_back(
      {{.title = "diverged runs", .key = "failed"}, [](R r) { return r.at.ate.failed; }});
  const auto add_spread = [&](const std::string& name, const char* key_unit,
                              const std::string& title, const char* unit, auto figure) {
    const auto add = [&](const char* part, const std::string& shown, auto of) {
      columns.push_back(
          {{.title = shown, .key = name + part + key_unit, .decimals = 9, .unit = unit},
           [=](R r) { return r.at.*figure.*of; }});
    };
    add("_median_", title, &Spread::median);
    add("_least_", "", &Spread::low);
    add("_greatest_", "", &Spread::high);
  };
  add_spread("ate", "m", "absolute error", "m", &ExploredPoint::OfSequence::ate);
  add_spread("relative", "percent", fmt::format("relative error, {:g} m", plan.measure.length_m),
             "%", &ExploredPoint::OfSequence::relative);
  return table_of(columns, point_rows(explored));
}

/// The data of a page, as the paper's figure has it: the absolute over the relative error of every
/// point.
Json exploration_page(const BatchPlan& plan, const std::vector<Dimension>& dimensions,
                      const std::vector<ExploredPoint>& explored) {
  StudyPage page;
  page.title = "Accuracy over parameters of the workload";
  for (const std::string& profile : plan.profiles) {
    StudyBox& box = page.boxes.emplace_back();
    box.mark = profile;
    box.sentence = gain_text(profile, explored);
    if (box.sentence.empty()) box.sentence = "It diverged at all points.";
    if (const ExploredPoint* best = best_of(explored, profile, &ExploredPoint::mean_ate))
      box.lines.push_back("best: " + set_text(*best));
  }
  page.summary = note(plan);
  page.points = points_table(plan, dimensions, explored);
  page.x = "relative_median_percent";
  page.y = "ate_median_m";
  page.colour = "profile";
  return study_report(page);
}

/// Point and dimensions of every run, for run_rows(). @param plan,dimensions  outlive the columns
RunColumns point_columns(const BatchPlan& plan, const std::vector<Dimension>& dimensions) {
  using R = const FinishedRun&;
  RunColumns columns{{{.key = "point"}, [&plan](R r) { return point_of_row(plan, r.point.row); }}};
  for (const Dimension& d : dimensions)
    columns.push_back({{.key = std::string(d.parameter->name)},
                       [&d](R r) { return spelled(value_of(d, r.point.request)); }});
  return columns;
}

/// From a quarter to four times the profile's, which has three digits.
Dimension around(const char* name, const RunRequest& profile) {
  const vio::Parameter* const parameter = vio::find_parameter(name);
  check(parameter != nullptr, name);
  double value = 0;
  check(base::parse_number(fmt::format("{:.3g}", value_of(profile, *parameter)), value), name);
  return {parameter, std::max(parameter->low, value / 4), std::min(parameter->high, value * 4)};
}

/// "workload.window=4:12"; toggles take no range: "workload.gravity_updates".
/// @throws InputError for unknown parameters and ranges outside of what they can be
Dimension parse_dimension(const std::string& text) {
  const std::string where = "--vary " + text;
  const std::size_t equals = text.find('=');
  const vio::Parameter& parameter = workload_parameter(where, text.substr(0, equals));
  if (parameter.is_of_another())
    throw InputError(where +
                     ": is no parameter of the odometry; expected one of leviosim workload "
                     "--profile levio");
  if (parameter.kind == vio::Parameter::Kind::toggle) {
    if (equals != std::string::npos)
      throw InputError(fmt::format("{}: is off or on; expected no range", where));
    return {&parameter, 0, 1};
  }
  const std::size_t colon = text.find(':');
  if (equals == std::string::npos || colon == std::string::npos || colon < equals)
    throw InputError(fmt::format("{}: expected NAME=LOW:HIGH", where));
  const Dimension dimension{
      &parameter,
      parse_workload_value(where, parameter, text.substr(equals + 1, colon - equals - 1)),
      parse_workload_value(where, parameter, text.substr(colon + 1))};
  if (!(dimension.low < dimension.high))
    throw InputError(fmt::format("{}: expected the lower value first", where));
  return dimension;
}

Domain domain_of(const Dimension& d) {
  using Kind = vio::Parameter::Kind;
  if (d.parameter->kind == Kind::toggle) return {{"off", "on"}, {}};
  const bool is_whole = d.parameter->kind == Kind::whole;
  return {{}, Span{d.low, d.high, !is_whole, is_whole, 1, {}}};
}

// `leviosim explore`: the paper's parameter sweep. Its folder:
//
//   manifest.json   what the batch was made from
//   runs.csv        a row per run
//   points.csv      a row per point, profile and sequence: medians and spread
//   best.md         the points of least error

constexpr std::int64_t kMostSampled = 1'000'000;

struct ExploreWords {
  BatchWords batch;
  std::vector<std::string> vary;
  std::string points = "40";
  std::string sample_seed = "1";
  std::string report;
};

std::vector<Dimension> dimensions_of(const ExploreWords& words) {
  std::vector<Dimension> dimensions;
  for (const std::string& text : words.vary) dimensions.push_back(parse_dimension(text));
  if (dimensions.empty()) dimensions = paper_dimensions();
  for (std::size_t i = 0; i < dimensions.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (dimensions[k].parameter == dimensions[i].parameter)
        throw InputError(fmt::format("--vary {}: is given twice", dimensions[i].parameter->name));
  return dimensions;
}

/// What only explorations need.
void check_plan(const BatchPlan& plan, const std::vector<Dimension>& dimensions) {
  if (plan.sizes.size() > 1)
    throw InputError("explore: --size: expected one image size; ablate compares several");
  for (const vio::Assignment& a : plan.workload)
    for (const Dimension& d : dimensions)
      if (a.parameter == d.parameter)
        throw InputError(fmt::format("-p {}: is varied; choose what is with --vary", a.text()));
  for (const Sequence& s : plan.sequences)
    if (s.path_m <= plan.measure.length_m)
      throw InputError(
          fmt::format("--relative {:g}: the path of {} is only {:.2f} m long; expected less",
                      plan.measure.length_m, s.folder, s.path_m));
}

Json manifest_of(const BatchPlan& plan, const ExploreWords& words,
                 const std::vector<Dimension>& dimensions, const Words& command_line) {
  Json manifest = batch_manifest(plan, command_line);
  manifest["points"] = words.points;
  manifest["sample_seed"] = words.sample_seed;
  for (const Dimension& d : dimensions)
    manifest["dimensions"].push_back({{"name", d.parameter->name},
                                      {"low", vio::value_text(*d.parameter, d.low)},
                                      {"high", vio::value_text(*d.parameter, d.high)},
                                      {"unit", d.parameter->unit}});
  return manifest;
}

void run(const CLI::App& command, const ExploreWords& words, const Words& command_line) {
  const std::vector<Dimension> dimensions = dimensions_of(words);
  const auto count =
      static_cast<std::size_t>(parse_whole("--points", words.points, 1, kMostSampled));
  const auto seed = static_cast<std::uint64_t>(
      parse_whole("--sample-seed", words.sample_seed, 0, std::numeric_limits<std::int64_t>::max()));
  std::optional<outputs::OutputFile> page = claimed_report(words.report, words.batch.force);
  const BatchPlan plan = make_plan(command, words.batch);
  check_plan(plan, dimensions);
  const auto points = sample_points(dimensions, count, seed);
  const std::vector<Point> runs = exploration_runs(plan, points);
  const std::vector<RunOutcome> outcomes = run_outcomes(runs, plan.measure, plan.runner);
  const std::vector<ExploredPoint> explored =
      explored_points(plan, dimensions, points, runs, outcomes);
  const Table table = points_table(plan, dimensions, explored);
  const Printout text = printout(
      words.batch.json,
      [&] {
        return Printout(fmt::format("leviosim {}: {} points, {} native runs\n{}", version(),
                                    points.size(), runs.size(), best_text(plan, explored)))
            .ending(exploration_conclusion(plan, explored), after_batch(plan));
      },
      [&] { return table_document("exploration", table); });
  publish(*plan.out, text, [&] {
    outputs::OutputFolder& out = *plan.out;
    out.write("runs.csv",
              csv_text(run_rows(runs, outcomes, plan.measure, point_columns(plan, dimensions))));
    out.write("points.csv", csv_text(table));
    out.write("best.md", best_markdown(plan, explored));
    out.write("manifest.json",
              json_text(manifest_of(plan, words, dimensions, command_line), 2) + '\n');
  });
  if (page) publish_report(page, exploration_page(plan, dimensions, explored), !words.batch.json);
}

}  // namespace

std::vector<vio::Assignment> effective(const std::vector<vio::Assignment>& point,
                                       const std::string& profile) {
  const bool use_imu = vio::uses_imu(profile);
  std::vector<vio::Assignment> set;
  for (const vio::Assignment& a : point)
    if (use_imu || !a.parameter->needs_imu) set.push_back(a);
  return set;
}

std::vector<Dimension> paper_dimensions() {
  const RunRequest levio = request_of("levio", {});
  return {{vio::find_parameter("workload.window"), 4, 16},
          around("workload.keyframe_parallax", levio),
          around("workload.reprojection_noise", levio),
          around("workload.imu_noise.gyro", levio),
          around("workload.imu_noise.accel", levio),
          {vio::find_parameter("workload.gravity_updates"), 0, 1}};
}

ExplorationPoints sample_points(const std::vector<Dimension>& dimensions, std::size_t count,
                                std::uint64_t seed) {
  ExplorationPoints points(count);
  for (std::size_t d = 0; d < dimensions.size(); ++d) {
    const vio::Parameter& parameter = *dimensions[d].parameter;
    const Domain domain = domain_of(dimensions[d]);
    const std::vector<double> draws = random_draws(count, d, seed);
    for (std::size_t i = 1; i < count; ++i)
      points[i].push_back(
          {&parameter, parse_workload_value("--vary", parameter, value_at(domain, draws[i]))});
  }
  return points;
}

Command add_explore_command(CLI::App& app, const Words& words) {
  CLI::App* command = app.add_subcommand(
      "explore", "The paper's parameter sweep: accuracy over parameters of the workload");
  const auto typed = std::make_shared<ExploreWords>();
  add_batch_options(*command, typed->batch);
  add_report_option(*command, typed->report);
  add_json_option(*command, typed->batch.json);
  const TextOptions add{*command};
  add("--vary", typed->vary, "NAME[=LOW:HIGH]",
      "parameter to vary, off and on if it is a switch; repeatable [the paper's five]");
  add("--points", typed->points, "N", "of the parameters, the profile's first [40]");
  add("--sample-seed", typed->sample_seed, "N", "of the points' random draws [1]");
  add_examples(*command,
               {"leviosim explore --data flight --profile levio --vary workload.window=6:12 "
                "--points 3 --seed 1 --relative 0.5 --out explored"});
  return {.app = command, .run = [=, &words] { run(*command, *typed, words); }, .goes_on = true};
}

}  // namespace leviosim::tools
