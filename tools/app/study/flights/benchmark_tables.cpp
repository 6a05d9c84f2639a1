#include "tools/app/study/flights/benchmark_tables.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <set>

#include "tools/app/study/accuracy_study.h"
#include "tools/app/study/finished_runs.h"
#include "tools/app/study/flights/benchmark.h"
#include "tools/app/study/flights/flight_plan.h"
#include "tools/app/study/flights/piece_figures.h"

namespace leviosim::tools {
namespace {

constexpr const char* kAllMotions = "all";

std::string motion_name(const Benchmark& benchmark, const BenchmarkRow& row) {
  return row.motion ? benchmark.motions[*row.motion].sequence.name : kAllMotions;
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

/// A figure of a row, in files to a millionth.
Column<BenchmarkRow> figure(const char* title, int rank, int shown, const char* key,
                            std::function<Cell(const BenchmarkRow&)> value) {
  return {{.title = title, .rank = rank, .shown = shown, .key = key, .decimals = 6},
          std::move(value)};
}

/// The median of an error, where it lies, and the worst. @param unit  "%", "percent" in files
void add_error(Columns<BenchmarkRow>& columns, const std::string& unit, const std::string& key,
               int shown, int rank, RowError BenchmarkRow::*of) {
  using R = const BenchmarkRow&;
  const auto add = [&](const std::string& title, int at, const std::string& name, auto value) {
    Column<BenchmarkRow> column = figure(title.c_str(), at, shown, name.c_str(), value);
    column.head.nothing = kDiverged;
    columns.push_back(std::move(column));
  };
  const auto add_end = [&](const char* title, const std::string& name,
                           MedianInterval RowError::*over,
                           std::optional<double> MedianInterval::*end) {
    add(title, rank + 2, name,
        [=](R r) { return (r.*of.*over).values < 2 ? Cell(kNothing) : Cell(r.*of.*over.*end); });
  };
  add("ATE " + unit, 0, key, [of](R r) { return (r.*of).median; });
  add_end(rank == 0 ? "from" : "", key + "_low", &RowError::over_pieces, &MedianInterval::low);
  add_end(rank == 0 ? "to" : "", key + "_high", &RowError::over_pieces, &MedianInterval::high);
  add_end("", key + "_seeds_low", &RowError::over_seeds, &MedianInterval::low);
  add_end("", key + "_seeds_high", &RowError::over_seeds, &MedianInterval::high);
  add("worst " + unit, rank, key + "_worst", [of](R r) { return (r.*of).worst; });
}

/// What tells the rows apart.
Columns<BenchmarkRow> row_columns(const Benchmark& benchmark) {
  using R = const BenchmarkRow&;
  const FlightPlan& plan = benchmark.plan;
  const auto setup = [](const char* title, const char* key, int rank) -> Head {
    return {.title = title, .align = kLeft, .rank = rank, .key = key, .is_setup = true};
  };
  return {{setup("profile", "variant", 1), [&](R r) { return plan.variants[r.variant].name(); }},
          {setup("piece", "piece", 1), [](R r) { return length_text(r.length); }},
          {setup("set", "set", 0), [&](R r) { return plan.sets[r.set].name; }},
          {setup("disturbance", "disturbance", 1),
           [&](R r) { return plan.disturbances[r.disturbance].text(); }},
          {setup("motion", "motion", 0), [&](R r) { return motion_name(benchmark, r); }},
          {{.title = "pieces", .rank = 4, .key = "pieces"}, [](R r) { return r.pieces; }},
          {{.title = "runs", .rank = 1, .key = "runs"}, [](R r) { return r.runs; }}};
}

/// How many runs said what of themselves; nothing where they say nothing.
Column<BenchmarkRow> alarm(const char* title, const char* key, std::size_t Alarms::*count) {
  return {{.title = title, .rank = 1, .key = key}, [count](const BenchmarkRow& r) {
            return r.alarms.runs > 0 ? Cell(r.alarms.*count) : Cell();
          }};
}

std::string health_text(const std::optional<Health>& health) {
  return health ? std::string(vio::kHealthNames[static_cast<std::size_t>(*health)]) : "";
}

}  // namespace

Table benchmark_rows(const Benchmark& benchmark, const BenchmarkResult& result) {
  using R = const BenchmarkRow&;
  Columns<BenchmarkRow> columns = row_columns(benchmark);
  add_error(columns, "%", "ate_percent", 2, 0, &BenchmarkRow::percent);
  add_error(columns, "m", "ate_m", 3, 1, &BenchmarkRow::metres);
  columns.push_back(figure("end m", 1, 3, "end_drift_m", [](R r) { return r.end_drift.median; }));
  columns.push_back(figure("scale", 4, 3, "scale", [](R r) { return r.scale.median; }));
  columns.push_back(figure("σ %", 3, 1, "scale_sigma_percent",
                           [](R r) { return scaled(r.scale_sigma.median, 100); }));
  columns.push_back({{.title = "diverged", .key = "diverged"}, [](R r) { return r.diverged; }});
  columns.push_back({{.title = "failed", .key = "failed"}, [](R r) { return r.failed; }});
  columns.push_back(alarm("", "judged", &Alarms::runs));
  columns.push_back(alarm("wrong", "wrong", &Alarms::failed));
  columns.push_back(alarm("detected", "detected", &Alarms::detected));
  columns.push_back(alarm("", "right", &Alarms::right));
  columns.push_back(alarm("false", "false_alarms", &Alarms::false_alarms));
  columns.push_back(alarm("silent", "silent", &Alarms::silent));
  columns.push_back({{.title = "restarts", .rank = 5, .key = "map_restarts"},
                     [](R r) { return r.map_restarts; }});
  return table_of(columns, result.rows);
}

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
      {{.key = "located_percent", .unit = "%"}, [](R r) { return judged_percent(r.outcome); }},
      {figure("scale", "scale_mean", "1"), [](R r) { return r.outcome.scale.mean; }},
      {figure("wander of the scale", "scale_sigma", "%", 100),
       [](R r) { return r.outcome.scale.sigma; }},
      {figure("drift at the end", "end_drift_m", "m"), [](R r) { return r.outcome.end_drift_m; }},
      {{.title = "restarts of the map", .key = "map_restarts"},
       [](R r) { return r.outcome.map_restarts; }},
      {{.key = "health"}, [](R r) { return health_text(r.outcome.health); }}};
  return run_rows(runs, outcomes, how, std::move(columns));
}

std::string benchmark_notes(const Benchmark& benchmark, const BenchmarkResult& result,
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
      "{0}from, to: where the median lies if the pieces are draws of many; confidence {2}; of "
      "seeds "
      "{3}\n"
      "{0}end: error of the last second after an alignment of the first 5 % of the path, median of "
      "runs\n"
      "{0}scale of the estimate in windows of 5 s, and its standard deviation in a flight: medians "
      "of runs; diverged: an error above the path\n"
      "{0}failed: runs that diverged, are lost, or have an error above {4:g} %; wrong: those with "
      "such an error; detected: of these, runs that end unreliable or lost; false: the same of "
      "runs below {5:g} %; "
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

std::string benchmark_conclusion(const Benchmark& benchmark, const BenchmarkResult& result) {
  const bool is_one_motion = benchmark.motions.size() == 1;  // which has no row for all
  std::string text;
  for (std::size_t v = 0; v < benchmark.plan.variants.size(); ++v) {
    const BenchmarkRow* worst = nullptr;
    for (const BenchmarkRow& row : result.rows)
      if (row.variant == v && row.motion.has_value() == is_one_motion &&
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

StudyPage benchmark_page(const Benchmark& benchmark, const BenchmarkResult& result, Table runs) {
  StudyPage page;
  page.title =
      fmt::format("Flights: {}", std::filesystem::path(benchmark.plan.name).stem().string());
  page.found = {{"Each profile on each set of flights", benchmark_rows(benchmark, result)}};
  page.summary = benchmark_notes(benchmark, result, "");
  page.points = std::move(runs);
  page.x = "path_m";
  page.y = "ate_percent";
  page.colour = "set";
  return page;
}

}  // namespace leviosim::tools
