#include "tools/app/study/flights/benchmark_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>

#include "tools/app/html_report/study_page.h"
#include "tools/app/record/statistic_list.h"
#include "tools/app/study/accuracy_study.h"
#include "tools/app/study/finished_runs.h"
#include "tools/app/study/flights/benchmark.h"
#include "tools/app/study/flights/benchmark_files.h"
#include "tools/app/study/flights/flight_plan.h"
#include "tools/app/study/flights/piece_figures.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {
namespace {

constexpr const char* kAllMotions = "all";

/// "1.2 … 3.4"; nothing of a single value.
std::string interval_text(const MedianInterval& interval, int decimals) {
  if (interval.values < 2) return kNothing;
  return fmt::format("{} … {}", error_text(interval.low, decimals),
                     error_text(interval.high, decimals));
}

std::string motion_name(const Benchmark& benchmark, const BenchmarkRow& row) {
  return row.motion ? benchmark.motions[*row.motion].sequence.name : kAllMotions;
}

/// "3 of 4".
std::string alarm_text(const Alarms& alarms, std::size_t count, std::size_t of) {
  return alarms.runs > 0 ? fmt::format("{} of {}", count, of) : kNothing;
}

/// Percent of the path for pieces, which differ in length; metres as well for whole flights.
Table benchmark_table(const Benchmark& benchmark, const BenchmarkResult& result) {
  using R = const BenchmarkRow&;
  const FlightPlan& plan = benchmark.plan;
  return table_of(
      Columns<BenchmarkRow>{
          {{"profile", kLeft, 1}, [&](R r) { return plan.variants[r.variant].name(); }},
          {{"piece", kLeft, 1}, [](R r) { return length_text(r.length); }},
          {{"set", kLeft}, [&](R r) { return plan.sets[r.set].name; }},
          {{"disturbance", kLeft, 1}, [&](R r) { return plan.disturbances[r.disturbance].text(); }},
          {{"motion", kLeft}, [&](R r) { return motion_name(benchmark, r); }},
          {{"pieces", kRight, 4}, [](R r) { return r.pieces; }},
          {{"ATE %"}, [](R r) { return error_text(r.percent.median, 2); }},
          {{"of pieces", kRight, 2}, [](R r) { return interval_text(r.percent.over_pieces, 2); }},
          {{"of seeds", kRight, 3}, [](R r) { return interval_text(r.percent.over_seeds, 2); }},
          {{"worst %"}, [](R r) { return error_text(r.percent.worst, 2); }},
          {{"ATE m"}, [](R r) { return error_text(r.metres.median, 3); }},
          {{"worst m", kRight, 1}, [](R r) { return error_text(r.metres.worst, 3); }},
          {{"end m", kRight, 1}, [](R r) { return figure_text(r.end_drift.median, 3); }},
          {{"scale", kRight, 4}, [](R r) { return figure_text(r.scale.median, 3); }},
          {{"σ %", kRight, 3},
           [](R r) { return figure_text(scaled(r.scale_sigma.median, 100), 1); }},
          {{"diverged"}, [](R r) { return fmt::format("{} of {}", r.diverged, r.runs); }},
          {{"failed"}, [](R r) { return r.failed; }},
          {{"detected", kRight, 1},
           [](R r) { return alarm_text(r.alarms, r.alarms.detected, r.alarms.failed); }},
          {{"false", kRight, 1},
           [](R r) { return alarm_text(r.alarms, r.alarms.false_alarms, r.alarms.right); }},
          {{"silent", kRight, 1},
           [](R r) { return r.alarms.runs > 0 ? std::to_string(r.alarms.silent) : kNothing; }},
          {{"restarts", kRight, 5}, [](R r) { return r.map_restarts; }}},
      result.rows);
}

/// "75 % (3 values), 96 % (9 values)".
std::string confidences(const std::vector<const MedianInterval*>& intervals) {
  std::set<std::string> texts;
  for (const MedianInterval* interval : intervals)
    if (interval->values >= 2)
      texts.insert(
          fmt::format("{:.0f} % ({} values)", 100 * interval->confidence, interval->values));
  return texts.empty() ? "none" : fmt::format("{}", fmt::join(texts, ", "));
}

std::string notes(const Benchmark& benchmark, const BenchmarkResult& result,
                  const std::string& bullet) {
  const FlightPlan& plan = benchmark.plan;
  std::vector<const MedianInterval*> of_pieces;
  std::vector<const MedianInterval*> of_seeds;
  for (const BenchmarkRow& row : result.rows) {
    of_pieces.push_back(&row.percent.over_pieces);
    of_seeds.push_back(&row.percent.over_seeds);
  }
  std::size_t at_rest = 0;
  for (const FlightMotion& motion : benchmark.motions) at_rest += motion.starts.at_rest;
  std::string text = fmt::format(
      "{0}ATE: SE3-aligned RMSE, % of the true path; median of the pieces, each with the median of "
      "seeds {1}; worst of all runs\n"
      "{0}of pieces, of seeds: where the median lies if these are draws of many; confidence of "
      "pieces {2}; of seeds {3}\n"
      "{0}end: error of the last second after an alignment of the first 5 % of the path, median of "
      "runs\n"
      "{0}scale of the estimate in windows of 5 s, and its standard deviation in a flight: medians "
      "of runs; diverged: an error above the path\n"
      "{0}failed: runs that diverged, are lost, or have an error above {4:g} %; detected: of those "
      "with "
      "such an error, runs that end unreliable or lost; false: the same of runs below {5:g} %; "
      "silent: runs above {6:g} % that end good\n",
      bullet, fmt::join(plan.seeds, ", "), confidences(of_pieces), confidences(of_seeds),
      kFailedPercent, kRightPercent, kSilentPercent);
  text += fmt::format(
      "{}a piece begins every {:g} s where the vehicle moves; left out of these starts: {} at "
      "rest, "
      "{} too near the end\n",
      bullet, plan.every_s, at_rest, benchmark.too_late);
  for (const FlightSet& set : plan.sets)
    text += fmt::format("{}{}: {}\n", bullet, set.name, set.text());
  return text;
}

Json interval_json(const MedianInterval& interval) {
  return {{"values", interval.values},
          {"confidence", rounded(interval.confidence)},
          {"low", figure_json(interval.low)},
          {"high", figure_json(interval.high)}};
}

Json error_json(const RowError& error, const char* unit) {
  return {{"unit", unit},
          {"median", figure_json(error.median)},
          {"over_pieces", interval_json(error.over_pieces)},
          {"over_seeds", interval_json(error.over_seeds)},
          {"worst", figure_json(error.worst)}};
}

Json spread_json(const Spread& spread) {
  return {{"runs", spread.runs},
          {"median", figure_json(spread.median)},
          {"low", figure_json(spread.low)},
          {"high", figure_json(spread.high)}};
}

Json row_json(const Benchmark& benchmark, const BenchmarkRow& row) {
  const FlightPlan& plan = benchmark.plan;
  return {{"variant", plan.variants[row.variant].name()},
          {"piece", length_text(row.length)},
          {"set", plan.sets[row.set].name},
          {"disturbance", plan.disturbances[row.disturbance].text()},
          {"motion", row.motion ? Json(motion_name(benchmark, row)) : Json(nullptr)},
          {"pieces", row.pieces},
          {"runs", row.runs},
          {"diverged", row.diverged},
          {"failed", row.failed},
          {"alarms",
           {{"runs", row.alarms.runs},
            {"failed", row.alarms.failed},
            {"detected", row.alarms.detected},
            {"right", row.alarms.right},
            {"false", row.alarms.false_alarms},
            {"silent", row.alarms.silent}}},
          {"map_restarts", row.map_restarts},
          {"ate_percent", error_json(row.percent, "%")},
          {"ate", error_json(row.metres, "m")},
          {"scale", spread_json(row.scale)},
          {"scale_sigma", spread_json(row.scale_sigma)},
          {"end_drift", spread_json(row.end_drift)}};
}

std::string health_text(const std::optional<Health>& health) {
  return health ? std::string(vio::kHealthNames[static_cast<std::size_t>(*health)]) : "";
}

// `leviosim benchmark-flights`: how accurate the workload is on flights not used for tuning. Its
// folder:
//
//   manifest.json   what the benchmark was made from
//   runs.csv        a row per run
//   pieces.csv      a row per profile and piece, over the seeds
//   table.md        the table that is printed
//   table.json      its rows and the pieces, with more digits

}  // namespace

Table piece_rows(const Benchmark& benchmark, const BenchmarkResult& result) {
  using R = const PieceRow&;
  const FlightPlan& plan = benchmark.plan;
  const auto of_piece = [&](auto of) {
    return [=, &benchmark](R r) { return Cell(of(benchmark.pieces[r.piece])); };
  };
  using P = const FlightPiece&;
  Columns<PieceRow> columns{
      {{.key = "variant"}, [&](R r) { return plan.variants[r.variant].name(); }},
      {{.key = "piece"}, of_piece([](P p) { return length_text(p.length); })},
      {{.key = "set"}, of_piece([&](P p) { return plan.sets[p.set].name; })},
      {{.key = "motion"}, of_piece([&](P p) { return benchmark.motions[p.motion].sequence.name; })},
      {{.key = "world"}, of_piece([](P p) { return p.world.text(); })},
      {{.key = "disturbance"},
       of_piece([&](P p) { return plan.disturbances[p.disturbance].text(); })},
      {{.key = "start_s", .decimals = 3}, of_piece([](P p) { return p.start_s; })},
      {{.key = "first_frame"}, of_piece([](P p) { return p.frames.begin; })},
      {{.key = "frames"}, of_piece([](P p) { return p.frames.end - p.frames.begin; })},
      {{.key = "path_m", .decimals = 6}, of_piece([](P p) { return p.path_m; })},
      {{.key = "runs"}, [](R r) { return r.percent.runs; }}};
  const auto add = [&](const std::string& key, Spread PieceRow::*of,
                       std::optional<double> Spread::*part) {
    columns.push_back({{.key = key, .decimals = 6}, [=](R r) { return r.*of.*part; }});
  };
  const auto add_spread = [&](const std::string& key, Spread PieceRow::*of) {
    add(key, of, &Spread::median);
    add(key + "_low", of, &Spread::low);
    add(key + "_high", of, &Spread::high);
  };
  add_spread("ate_percent", &PieceRow::percent);
  add_spread("ate_m", &PieceRow::metres);
  add_spread("scale", &PieceRow::scale);
  add("scale_sigma", &PieceRow::scale_sigma, &Spread::median);
  add("end_drift_m", &PieceRow::end_drift, &Spread::median);
  columns.push_back({{.key = "diverged"}, [](R r) { return r.diverged; }});
  columns.push_back({{.key = "failed"}, [](R r) { return r.failed; }});
  columns.push_back({{.key = "silent"}, [](R r) { return r.alarms.silent; }});
  columns.push_back({{.key = "map_restarts"}, [](R r) { return r.map_restarts; }});
  return table_of(columns, result.pieces);
}

std::string benchmark_conclusion(const Benchmark& benchmark, const BenchmarkResult& result) {
  std::string text;
  for (std::size_t v = 0; v < benchmark.plan.variants.size(); ++v) {
    const BenchmarkRow* worst = nullptr;
    for (const BenchmarkRow& row : result.rows)
      if (row.variant == v && !row.motion &&
          (worst == nullptr || !row.percent.median ||
           (worst->percent.median && *row.percent.median > *worst->percent.median)))
        worst = &row;
    if (worst != nullptr)
      text += fmt::format("{}{}: at most {} % of the path in the median, {} of {} runs diverged",
                          text.empty() ? "in short: " : "; ", benchmark.plan.variants[v].name(),
                          error_text(worst->percent.median, 2), worst->diverged, worst->runs);
  }
  return text;
}

std::string benchmark_markdown(const Benchmark& benchmark, const BenchmarkResult& result) {
  return markdown_table(benchmark_table(benchmark, result)) + '\n' + notes(benchmark, result, "- ");
}

std::string benchmark_text(const Benchmark& benchmark, const BenchmarkResult& result, int width) {
  return terminal_text(benchmark_table(benchmark, result), width) + notes(benchmark, result, "  ");
}

Json benchmark_json(const Benchmark& benchmark, const BenchmarkResult& result) {
  Json document;
  document["format"] = "leviosim flight benchmark";
  document["version"] = 1;
  document["plan"] = benchmark.plan.name;
  document["rows"] = Json::array();
  for (const BenchmarkRow& row : result.rows) document["rows"].push_back(row_json(benchmark, row));
  document["pieces"] = rows_json(piece_rows(benchmark, result));
  return document;
}

Table benchmark_runs_table(const Benchmark& benchmark, const std::vector<Point>& runs,
                           const std::vector<RunOutcome>& outcomes, const Measure& how) {
  using R = const FinishedRun&;
  using P = const FlightPiece&;
  const FlightPlan& plan = benchmark.plan;
  const auto setup = [](const char* title, const char* key, const char* unit = "") -> Head {
    return {.title = title, .key = key, .unit = unit, .is_setup = true};
  };
  const auto figure = [](const char* title, const char* key, const char* unit,
                         double scale = 1) -> Head {
    return {.title = title, .key = key, .decimals = 6, .unit = unit, .scale = scale};
  };
  const auto of_piece = [&](auto of) {
    return [=, &benchmark](R r) {
      return Cell(of(benchmark.pieces[r.point.row % benchmark.pieces.size()]));
    };
  };
  Head start = setup("start", "start_s", "s");
  start.decimals = 3;
  RunColumns columns{
      {setup("profile", "variant"),
       [&](R r) { return plan.variants[r.point.row / benchmark.pieces.size()].name(); }},
      {setup("set", "set"), of_piece([&](P p) { return plan.sets[p.set].name; })},
      {setup("world", "world"), of_piece([](P p) { return p.world.text(); })},
      {setup("disturbance", "disturbance"),
       of_piece([&](P p) { return plan.disturbances[p.disturbance].text(); })},
      {setup("piece", "piece"), of_piece([](P p) { return length_text(p.length); })},
      {start, of_piece([](P p) { return p.start_s; })},
      {{.key = "first_frame"}, of_piece([](P p) { return p.frames.begin; })},
      {figure("error (ATE) over the path", "ate_percent", "%"),
       [](R r) { return error_percent(r.outcome); }},
      {figure("scale", "scale_mean", "1"), [](R r) { return r.outcome.scale.mean; }},
      {figure("wander of the scale", "scale_sigma", "%", 100),
       [](R r) { return r.outcome.scale.sigma; }},
      {figure("drift at the end", "end_drift_m", "m"), [](R r) { return r.outcome.end_drift_m; }},
      {{.title = "restarts of the map", .key = "map_restarts"},
       [](R r) { return r.outcome.map_restarts; }},
      {{.key = "health"}, [](R r) { return health_text(r.outcome.health); }}};
  return run_rows(runs, outcomes, how, std::move(columns));
}

Json benchmark_page(const Benchmark& benchmark, const BenchmarkResult& result, Table runs) {
  StudyPage page;
  page.title = fmt::format("Flights: {}", benchmark.plan.name);
  page.summary = benchmark_text(benchmark, result, kAnyWidth);
  page.points = std::move(runs);
  page.x = "path_m";
  page.y = "ate_percent";
  page.colour = "set";
  return study_report(page);
}

}  // namespace leviosim::tools
