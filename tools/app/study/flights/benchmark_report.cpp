#include "tools/app/study/flights/benchmark_report.h"

#include <fmt/core.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>

#include "tools/app/cli/version.h"
#include "tools/app/html_report/page_json.h"
#include "tools/app/report/table_document.h"
#include "tools/app/report/text_table.h"
#include "tools/app/study/run_outcome.h"

namespace leviosim::tools {
namespace {

constexpr const char* kAllMotions = "all";
constexpr const char* kDiverged = "diverged";

std::string error_text(const std::optional<double>& error, int decimals) {
  return figure_text(error, decimals, kDiverged);
}

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
TextTable table_of(const Benchmark& benchmark, const BenchmarkResult& result) {
  const FlightPlan& plan = benchmark.plan;
  TextTable table({{"profile", kLeft, 1},
                   {"piece", kLeft, 1},
                   {"set", kLeft},
                   {"disturbance", kLeft, 1},
                   {"motion", kLeft},
                   {"pieces", kRight, 4},
                   {"ATE %"},
                   {"of pieces", kRight, 2},
                   {"of seeds", kRight, 3},
                   {"worst %"},
                   {"ATE m"},
                   {"worst m", kRight, 1},
                   {"end m", kRight, 1},
                   {"scale", kRight, 4},
                   {"σ %", kRight, 3},
                   {"diverged"},
                   {"failed"},
                   {"detected", kRight, 1},
                   {"false", kRight, 1},
                   {"silent", kRight, 1},
                   {"restarts", kRight, 5}});
  for (const BenchmarkRow& row : result.rows)
    table.add({plan.variants[row.variant].name(),
               length_text(row.length),
               plan.sets[row.set].name,
               plan.disturbances[row.disturbance].text(),
               motion_name(benchmark, row),
               fmt::format("{}", row.pieces),
               error_text(row.percent.median, 2),
               interval_text(row.percent.over_pieces, 2),
               interval_text(row.percent.over_seeds, 2),
               error_text(row.percent.worst, 2),
               error_text(row.metres.median, 3),
               error_text(row.metres.worst, 3),
               figure_text(row.end_drift.median, 3),
               figure_text(row.scale.median, 3),
               figure_text(row.scale_sigma.median ? std::optional(100 * *row.scale_sigma.median)
                                                  : std::nullopt,
                           1),
               fmt::format("{} of {}", row.diverged, row.runs),
               fmt::format("{}", row.failed),
               alarm_text(row.alarms, row.alarms.detected, row.alarms.failed),
               alarm_text(row.alarms, row.alarms.false_alarms, row.alarms.right),
               row.alarms.runs > 0 ? fmt::format("{}", row.alarms.silent) : kNothing,
               fmt::format("{}", row.map_restarts)});
  return table;
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

Json value(const std::optional<double>& v) { return v ? rounded(*v) : Json(nullptr); }

Json interval_json(const MedianInterval& interval) {
  return {{"values", interval.values},
          {"confidence", rounded(interval.confidence)},
          {"low", value(interval.low)},
          {"high", value(interval.high)}};
}

Json error_json(const RowError& error, const char* unit) {
  return {{"unit", unit},
          {"median", value(error.median)},
          {"over_pieces", interval_json(error.over_pieces)},
          {"over_seeds", interval_json(error.over_seeds)},
          {"worst", value(error.worst)}};
}

Json spread_json(const Spread& spread) {
  return {{"runs", spread.runs},
          {"median", value(spread.median)},
          {"low", value(spread.low)},
          {"high", value(spread.high)}};
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

}  // namespace

std::string benchmark_text(const Benchmark& benchmark, const BenchmarkResult& result, int width) {
  return table_of(benchmark, result).str(width) + notes(benchmark, result, "  ");
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
  return table_of(benchmark, result).markdown() + '\n' + notes(benchmark, result, "- ");
}

Json benchmark_json(const Benchmark& benchmark, const BenchmarkResult& result) {
  Json document;
  document["format"] = "leviosim flight benchmark";
  document["version"] = 1;
  document["plan"] = benchmark.plan.name;
  document["rows"] = Json::array();
  for (const BenchmarkRow& row : result.rows) document["rows"].push_back(row_json(benchmark, row));
  document["pieces"] = rows_of_csv(pieces_csv(benchmark, result));
  return document;
}

namespace {

std::string health_text(const std::optional<Health>& health) {
  return health ? std::string(vio::kHealthNames[static_cast<std::size_t>(*health)]) : "";
}

}  // namespace

std::string benchmark_runs_csv(const Benchmark& benchmark, const std::vector<Point>& runs,
                               const std::vector<RunOutcome>& outcomes, const Measure& how) {
  using Run = const FinishedRun&;
  const FlightPlan& plan = benchmark.plan;
  const auto piece_of = [&](Run r) -> const FlightPiece& {
    return benchmark.pieces[r.point.row % benchmark.pieces.size()];
  };
  RunColumns columns;
  columns.add("variant",
              [&](Run r) { return plan.variants[r.point.row / benchmark.pieces.size()].name(); });
  columns.add("set", [=, &plan](Run r) { return plan.sets[piece_of(r).set].name; });
  columns.add("world", [=](Run r) { return piece_of(r).world.text(); });
  columns.add("disturbance",
              [=, &plan](Run r) { return plan.disturbances[piece_of(r).disturbance].text(); });
  columns.add("piece", [=](Run r) { return length_text(piece_of(r).length); });
  columns.add("start_s", [=](Run r) { return base::fixed(piece_of(r).start_s, 3); });
  columns.add("first_frame", [=](Run r) { return piece_of(r).frames.begin; });
  columns.add("ate_percent", [](Run r) { return base::fixed(error_percent(r.outcome), 6); });
  columns.add("scale_mean", [](Run r) { return base::fixed(r.outcome.scale.mean, 6); });
  columns.add("scale_sigma", [](Run r) { return base::fixed(r.outcome.scale.sigma, 6); });
  columns.add("end_drift_m", [](Run r) { return base::fixed(r.outcome.end_drift_m, 6); });
  columns.add("map_restarts", [](Run r) { return r.outcome.map_restarts; });
  columns.add("health", [](Run r) { return health_text(r.outcome.health); });
  return runs_csv(runs, outcomes, how, std::move(columns));
}

std::string pieces_csv(const Benchmark& benchmark, const BenchmarkResult& result) {
  using R = const PieceRow&;
  using base::fixed;
  const FlightPlan& plan = benchmark.plan;
  const auto piece_of = [&](R row) -> const FlightPiece& { return benchmark.pieces[row.piece]; };
  base::CsvTable<PieceRow> table;
  table.add("variant", [&](R r) { return plan.variants[r.variant].name(); });
  table.add("piece", [=](R r) { return length_text(piece_of(r).length); });
  table.add("set", [=, &plan](R r) { return plan.sets[piece_of(r).set].name; });
  table.add("motion",
            [=, &benchmark](R r) { return benchmark.motions[piece_of(r).motion].sequence.name; });
  table.add("world", [=](R r) { return piece_of(r).world.text(); });
  table.add("disturbance",
            [=, &plan](R r) { return plan.disturbances[piece_of(r).disturbance].text(); });
  table.add("start_s", [=](R r) { return fixed(piece_of(r).start_s, 3); });
  table.add("first_frame", [=](R r) { return piece_of(r).frames.begin; });
  table.add("frames", [=](R r) { return piece_of(r).frames.end - piece_of(r).frames.begin; });
  table.add("path_m", [=](R r) { return fixed(piece_of(r).path_m, 6); });
  table.add("runs", [](R r) { return r.percent.runs; });
  const auto add = [&](const std::string& name, auto of) {
    table.add(name, [of](R r) { return fixed(of(r), 6); });
  };
  const auto add_spread = [&](const std::string& name, Spread PieceRow::*of) {
    add(name, [of](R r) { return (r.*of).median; });
    add(name + "_low", [of](R r) { return (r.*of).low; });
    add(name + "_high", [of](R r) { return (r.*of).high; });
  };
  add_spread("ate_percent", &PieceRow::percent);
  add_spread("ate_m", &PieceRow::metres);
  add_spread("scale", &PieceRow::scale);
  add("scale_sigma", [](R r) { return r.scale_sigma.median; });
  add("end_drift_m", [](R r) { return r.end_drift.median; });
  table.add("diverged", [](R r) { return r.diverged; });
  table.add("failed", [](R r) { return r.failed; });
  table.add("silent", [](R r) { return r.alarms.silent; });
  table.add("map_restarts", [](R r) { return r.map_restarts; });
  return table.text(result.pieces);
}

Json benchmark_manifest(const Benchmark& benchmark, const Measure& how, const Words& command_line) {
  const FlightPlan& plan = benchmark.plan;
  Json document = study_manifest("leviosim flight benchmark manifest", command_line);
  document["plan"] = {{"name", plan.name}, {"text", plan.text}};
  document["variants"] = Json::array();
  for (const FlightVariant& variant : plan.variants) document["variants"].push_back(variant.name());
  document["seeds"] = plan.seeds;
  document["measure"] = measure_text(how);
  document["drawn_by"] = flight_version();
  for (const FlightMotion& motion : benchmark.motions)
    document["motions"].push_back({{"name", motion.sequence.name},
                                   {"frames", motion.sequence.frames},
                                   {"path_m", rounded(motion.sequence.path_m)},
                                   {"inputs_sha256", motion.sequence.inputs},
                                   {"starts", motion.starts.frames},
                                   {"starts_at_rest", motion.starts.at_rest}});
  return document;
}

Json benchmark_page(const Benchmark& benchmark, const BenchmarkResult& result,
                    const std::string& csv) {
  StudyPage page;
  page.title = fmt::format("Flights: {}", benchmark.plan.name);
  page.summary = benchmark_text(benchmark, result, kAnyWidth);
  page.points = csv;
  page.columns = {{"variant", "profile", "", true},
                  {"piece", "piece", "", true},
                  {"set", "set", "", true},
                  {"sequence", "motion", "", true},
                  {"world", "world", "", true},
                  {"disturbance", "disturbance", "", true},
                  {"start_s", "start", "s", true},
                  {"seed", "seed", "", true},
                  {"path_m", "path", "m", true},
                  {"ate_percent", "error (ATE) over the path", "%"},
                  {"ate_rmse_m", "error (ATE)", "m"},
                  {"scale_mean", "scale", "1"},
                  {"scale_sigma", "wander of the scale", "%", false, false, 100},
                  {"end_drift_m", "drift at the end", "m"},
                  {"map_restarts", "restarts of the map", ""},
                  {"completion", "completion", "%", false, true, 100},
                  {"failure", "failure", ""}};
  page.x = "path_m";
  page.y = "ate_percent";
  page.colour = "set";
  return study_report(page);
}

}  // namespace leviosim::tools
