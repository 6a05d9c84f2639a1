#include "tools/app/study/ablate/ablation.h"

#include <fmt/core.h>

#include <algorithm>

#include "sim/base/interruption.h"
#include "tools/app/study/ablate/published_accuracy.h"

namespace leviosim::tools {
namespace {

using PaperFigure = PublishedAccuracy::Figure;

std::optional<AblationRow::Paper> paper_value(const std::vector<PublishedAccuracy>& published,
                                              const AblationRow& row, PaperFigure figure) {
  std::optional<AblationRow::Paper> found;
  for (const PublishedAccuracy& p : published) {
    if (p.sequence != row.sequence || p.estimator != row.profile ||
        p.chosen_by != PaperFigure::ate || p.figure != figure)
      continue;
    if (p.size == row.size) return AblationRow::Paper{p.value, p.size};
    if (!found || p.size.width > found->size.width) found = {p.value, p.size};
  }
  return found;
}

std::optional<AblationRow::Paper> mean_paper(const std::vector<const AblationRow*>& rows,
                                             std::optional<AblationRow::Paper> AblationRow::*of) {
  const std::optional<double> mean = mean_of(values_of(rows, [of](const AblationRow* r) {
    return r->*of ? std::optional((r->*of)->value) : std::nullopt;
  }));
  if (!mean) return std::nullopt;
  return AblationRow::Paper{*mean, (rows.front()->*of)->size};
}

/// @param like  whose size, profile and point it is of
AblationRow mean_row(const std::vector<AblationRow>& all, const AblationRow& like) {
  AblationRow mean{
      .size = like.size, .profile = like.profile, .point = like.point, .set = like.set};
  std::vector<const AblationRow*> rows;
  for (const AblationRow& row : all) {
    if (row.profile != like.profile || row.size != like.size || row.point != like.point) continue;
    rows.push_back(&row);
    mean.ate.runs += row.ate.runs;
    mean.ate.failed += row.ate.failed;
    mean.relative.runs += row.relative.runs;
  }
  mean.ate.median = mean_of(values_of(rows, [](const AblationRow* r) { return r->ate.median; }));
  mean.relative.median =
      mean_of(values_of(rows, [](const AblationRow* r) { return r->relative.median; }));
  // A sequence that is too short for relative errors has none to average, which is no failure.
  if (std::any_of(rows.begin(), rows.end(),
                  [](const AblationRow* row) { return row->relative.runs == 0; }))
    mean.relative.runs = 0;
  mean.paper_ate = mean_paper(rows, &AblationRow::paper_ate);
  mean.paper_relative = mean_paper(rows, &AblationRow::paper_relative);
  return mean;
}

/// Errors over these outcomes.
void condense(const std::vector<RunOutcome>& outcomes, AblationRow& row) {
  row.ate = spread_of(values_of(outcomes, &RunOutcome::ate_m));
  std::vector<std::optional<double>> relative;
  for (const RunOutcome& o : outcomes) {
    const bool failed = !o.failure.empty();
    if (failed || o.relative_percent) relative.push_back(o.relative_percent);
    if (failed) continue;
    row.least_completion = std::min(row.least_completion.value_or(o.completion), o.completion);
    if (std::find(row.protocols.begin(), row.protocols.end(), o.protocol) == row.protocols.end())
      row.protocols.push_back(o.protocol);
  }
  row.relative = spread_of(relative);
}

/// Rows without figures, in their order, but for the means.
std::vector<AblationRow> empty_rows(const Ablation& ablation) {
  std::vector<AblationRow> rows;
  for (const std::string& sequence : sequence_names(ablation.plan))
    for (const traces::ImageSize& size : ablation.plan.sizes)
      for (const std::string& profile : ablation.plan.profiles)
        for (std::size_t point = 0; point < ablation.points.size(); ++point)
          rows.push_back({.sequence = sequence,
                          .size = size,
                          .profile = profile,
                          .point = point,
                          .set = effective(ablation.points[point], profile)});
  return rows;
}

}  // namespace

std::vector<Point> ablation_runs(const Ablation& ablation) {
  std::vector<Point> runs;
  std::size_t number = 0;
  for (const AblationRow& row : empty_rows(ablation)) {
    throw_if_interrupted();
    for (const Sequence& sequence : ablation.plan.sequences)
      for (const std::uint32_t seed : ablation.plan.seeds) {
        if (sequence.name != row.sequence) continue;
        Point& run =
            runs.emplace_back(make_run(ablation.plan, sequence, row.profile, row.size, seed));
        run.request.workload.insert(run.request.workload.end(), row.set.begin(), row.set.end());
        run.row = number;
      }
    ++number;
  }
  return runs;
}

std::vector<AblationRow> ablation_rows(const Ablation& ablation, const std::vector<Point>& runs,
                                       const std::vector<RunOutcome>& outcomes,
                                       const std::vector<PublishedAccuracy>& published) {
  std::vector<AblationRow> rows = empty_rows(ablation);
  const auto of_rows = by_row(runs, outcomes, rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    condense(of_rows[i], rows[i]);
    if (rows[i].point != 0) continue;
    rows[i].paper_ate = paper_value(published, rows[i], PaperFigure::ate);
    if (ablation.plan.measure.length_m == kPaperLengthM)
      rows[i].paper_relative = paper_value(published, rows[i], PaperFigure::relative);
  }
  const std::size_t sequences = sequence_names(ablation.plan).size();
  if (sequences < 2) return rows;
  const std::vector<AblationRow> single = rows;
  for (std::size_t i = 0; i < single.size() / sequences; ++i)
    rows.push_back(mean_row(single, single[i]));
  return rows;
}

const AblationRow* best_row(const std::vector<AblationRow>& rows, const std::string& profile,
                            Spread AblationRow::*by) {
  const AblationRow* best = nullptr;
  for (const AblationRow& row : rows) {
    if (row.profile != profile || !(row.*by).median) continue;
    if (row.sequence.empty() != rows.back().sequence.empty()) continue;  // the means come last
    if (best == nullptr || *(row.*by).median < *(best->*by).median) best = &row;
  }
  return best;
}

const AblationRow* row_as_it_is(const std::vector<AblationRow>& rows, const std::string& profile) {
  for (const AblationRow& row : rows)
    if (row.profile == profile && row.point == 0 &&
        row.sequence.empty() == rows.back().sequence.empty())
      return &row;
  return nullptr;
}

}  // namespace leviosim::tools
