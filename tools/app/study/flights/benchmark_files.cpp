#include "tools/app/study/flights/benchmark_files.h"

#include <fmt/core.h>

#include "tools/app/cli/version.h"
#include "tools/app/html_report/study_json.h"
#include "tools/app/report/text_table.h"
#include "tools/app/study/flights/benchmark_report.h"
#include "tools/app/study/runs_csv.h"

namespace leviosim::tools {

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
