#include "tools/app/study/flights/piece_figures.h"

#include <functional>

#include "tools/app/study/flights/benchmark.h"
#include "tools/app/study/flights/flight_plan.h"

namespace leviosim::tools {
namespace {

using Values = std::vector<std::optional<double>>;

/// The outcomes of a piece, by seed.
using Seeds = std::vector<RunOutcome>;

using Figure = std::function<std::optional<double>(const RunOutcome&)>;

/// Of those runs that have the figure.
Spread spread_of_known(const std::vector<const Seeds*>& pieces, const Figure& of) {
  Values known;
  for (const Seeds* seeds : pieces)
    for (const RunOutcome& outcome : *seeds)
      if (const std::optional<double> value = of(outcome)) known.push_back(value);
  return spread_of(known);
}

std::optional<double> median_of(const Values& values) { return spread_of(values).median; }

RowError error_over(const std::vector<const Seeds*>& pieces, const Figure& of) {
  RowError error;
  Values of_pieces;
  Values all;
  for (const Seeds* seeds : pieces) {
    const Values values = values_of(*seeds, of);
    of_pieces.push_back(median_of(values));
    all.insert(all.end(), values.begin(), values.end());
  }
  Values of_seeds;
  for (std::size_t seed = 0; seed < pieces.front()->size(); ++seed)
    of_seeds.push_back(
        median_of(values_of(pieces, [&](const Seeds* seeds) { return of(seeds->at(seed)); })));
  error.median = median_of(of_pieces);
  error.over_pieces = median_interval(of_pieces);
  error.over_seeds = median_interval(of_seeds);
  error.worst = spread_of(all).high;
  return error;
}

std::optional<double> scale_mean(const RunOutcome& o) { return o.scale.mean; }

std::optional<double> scale_sigma(const RunOutcome& o) { return o.scale.sigma; }

std::optional<double> end_drift(const RunOutcome& o) { return o.end_drift_m; }

PieceRow piece_row(std::size_t variant, std::size_t piece, const Seeds& seeds) {
  PieceRow row;
  row.variant = variant;
  row.piece = piece;
  row.percent = spread_of(values_of(seeds, error_percent));
  row.metres = spread_of(values_of(seeds, error_of));
  row.scale = spread_of_known({&seeds}, scale_mean);
  row.scale_sigma = spread_of_known({&seeds}, scale_sigma);
  row.end_drift = spread_of_known({&seeds}, end_drift);
  row.diverged = row.percent.failed;
  for (const RunOutcome& outcome : seeds) {
    row.map_restarts += outcome.map_restarts;
    row.failed += failed(outcome) ? 1 : 0;
    row.alarms.add(outcome);
  }
  return row;
}

/// Pieces of all lengths, sets and motions in which `row` lies.
class RowMaker {
 public:
  RowMaker(const Benchmark& benchmark, const std::vector<Seeds>& outcomes,
           const std::vector<PieceRow>& pieces)
      : benchmark_(benchmark), outcomes_(outcomes), pieces_(pieces) {}

  /// Nothing if it has no pieces.
  std::optional<BenchmarkRow> make(BenchmarkRow row) const {
    std::vector<const Seeds*> mine;
    for (std::size_t p = 0; p < benchmark_.pieces.size(); ++p) {
      const FlightPiece& piece = benchmark_.pieces[p];
      if (piece.length != row.length || piece.set != row.set) continue;
      if (piece.disturbance != row.disturbance) continue;
      if (row.motion && piece.motion != *row.motion) continue;
      const std::size_t at = row_of(benchmark_, row.variant, p);
      mine.push_back(&outcomes_[at]);
      row.diverged += pieces_[at].diverged;
      row.failed += pieces_[at].failed;
      for (const RunOutcome& outcome : outcomes_[at]) row.alarms.add(outcome);
      row.map_restarts += pieces_[at].map_restarts;
    }
    if (mine.empty()) return std::nullopt;
    row.pieces = mine.size();
    row.runs = mine.size() * benchmark_.plan.seeds.size();
    row.percent = error_over(mine, error_percent);
    row.metres = error_over(mine, error_of);
    row.scale = spread_of_known(mine, scale_mean);
    row.scale_sigma = spread_of_known(mine, scale_sigma);
    row.end_drift = spread_of_known(mine, end_drift);
    return row;
  }

 private:
  const Benchmark& benchmark_;
  const std::vector<Seeds>& outcomes_;
  const std::vector<PieceRow>& pieces_;
};

}  // namespace

std::optional<double> error_percent(const RunOutcome& outcome) {
  const std::optional<double> error = error_of(outcome);
  if (!error || outcome.path_m <= 0) return std::nullopt;
  return 100 * *error / outcome.path_m;
}

std::optional<double> judged_percent(const RunOutcome& outcome) {
  RunOutcome judged = outcome;
  if (outcome.located_m) judged.ate_m = outcome.located_m;
  return error_percent(judged);
}

bool failed(const RunOutcome& outcome) {
  const std::optional<double> error = error_percent(outcome);
  return !error || *error > kFailedPercent || outcome.health == Health::lost;
}

void Alarms::add(const RunOutcome& outcome) {
  if (!outcome.health) return;
  const std::optional<double> error = judged_percent(outcome);
  // What does not watch its map is as silent as what takes it for good.
  const bool good = outcome.health == Health::good || outcome.health == Health::not_judged;
  const bool wrong = !error || *error > kFailedPercent;
  const auto count = [](bool is) { return is ? std::size_t{1} : std::size_t{0}; };
  runs += 1;
  failed += count(wrong);
  detected += count(wrong && !good);
  right += count(error && *error < kRightPercent);
  false_alarms += count(error && *error < kRightPercent && !good);
  silent += count((!error || *error > kSilentPercent) && good);
}

BenchmarkResult condense(const Benchmark& benchmark, const std::vector<Point>& runs,
                         const std::vector<RunOutcome>& outcomes) {
  const FlightPlan& plan = benchmark.plan;
  const std::vector<Seeds> of_rows =
      by_row(runs, outcomes, plan.variants.size() * benchmark.pieces.size());
  BenchmarkResult result;
  for (std::size_t variant = 0; variant < plan.variants.size(); ++variant)
    for (std::size_t piece = 0; piece < benchmark.pieces.size(); ++piece)
      result.pieces.push_back(
          piece_row(variant, piece, of_rows[row_of(benchmark, variant, piece)]));
  const RowMaker maker(benchmark, of_rows, result.pieces);
  const auto add = [&](const BenchmarkRow& row) {
    if (const std::optional<BenchmarkRow> made = maker.make(row)) result.rows.push_back(*made);
  };
  for (std::size_t variant = 0; variant < plan.variants.size(); ++variant)
    for (const std::size_t length : plan.lengths)
      for (std::size_t set = 0; set < plan.sets.size(); ++set)
        for (std::size_t d = 0; d < plan.disturbances.size(); ++d) {
          BenchmarkRow row;
          row.variant = variant;
          row.length = length;
          row.set = set;
          row.disturbance = d;
          for (row.motion = 0; *row.motion < benchmark.motions.size(); ++*row.motion) add(row);
          row.motion.reset();
          const bool recorded = plan.sets[set].recorded();
          if ((recorded ? plan.recordings : plan.motions).size() > 1) add(row);
        }
  return result;
}

}  // namespace leviosim::tools
