#include "tools/app/study/ablate/ablation.h"

#include <fmt/core.h>

#include <algorithm>

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

AblationRow mean_row(const std::vector<AblationRow>& all, const traces::ImageSize& size,
                     const std::string& profile) {
  AblationRow mean;
  mean.size = size;
  mean.profile = profile;
  std::vector<const AblationRow*> rows;
  for (const AblationRow& row : all) {
    if (row.profile != profile || row.size != size) continue;
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

AblationRow row_of(const std::string& sequence, const traces::ImageSize& size,
                   const std::string& profile, const std::vector<RunOutcome>& outcomes) {
  AblationRow row{sequence, size, profile, {}, {}, {}, {}, {}, {}};
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
  return row;
}

}  // namespace

std::vector<Point> ablation_runs(const BatchPlan& plan) {
  std::vector<Point> runs;
  std::size_t row = 0;
  for (const std::string& name : sequence_names(plan))
    for (const traces::ImageSize& size : plan.sizes)
      for (const std::string& profile : plan.profiles) {
        for (const Sequence& sequence : plan.sequences)
          for (const std::uint32_t seed : plan.seeds) {
            if (sequence.name != name) continue;
            runs.push_back(make_run(plan, sequence, profile, size, seed));
            runs.back().row = row;
          }
        ++row;
      }
  return runs;
}

std::vector<AblationRow> ablation_rows(const BatchPlan& plan, const std::vector<Point>& runs,
                                       const std::vector<RunOutcome>& outcomes,
                                       const std::vector<PublishedAccuracy>& published) {
  const std::vector<std::string> sequences = sequence_names(plan);
  const auto of_rows =
      by_row(runs, outcomes, sequences.size() * plan.sizes.size() * plan.profiles.size());
  std::vector<AblationRow> rows;
  for (const std::string& sequence : sequences)
    for (const traces::ImageSize& size : plan.sizes)
      for (const std::string& profile : plan.profiles) {
        AblationRow row = row_of(sequence, size, profile, of_rows[rows.size()]);
        row.paper_ate = paper_value(published, row, PaperFigure::ate);
        if (plan.measure.length_m == kPaperLengthM)
          row.paper_relative = paper_value(published, row, PaperFigure::relative);
        rows.push_back(std::move(row));
      }
  if (sequences.size() < 2) return rows;
  const std::vector<AblationRow> single = rows;
  for (const traces::ImageSize& size : plan.sizes)
    for (const std::string& profile : plan.profiles)
      rows.push_back(mean_row(single, size, profile));
  return rows;
}

}  // namespace leviosim::tools
