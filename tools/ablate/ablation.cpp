#include "tools/ablate/ablation.h"

#include <algorithm>

namespace leviosim::tools {
namespace {

using Figure = PaperAccuracy::Figure;

std::optional<double> paper_value(const std::vector<PaperAccuracy>& paper, const AblationRow& row,
                                  Figure figure) {
  for (const PaperAccuracy& p : paper)
    if (p.sequence == row.sequence && p.profile == row.profile && p.size.width == row.size.width &&
        p.size.height == row.size.height && p.chosen_by == Figure::ate && p.figure == figure)
      return p.value;
  return std::nullopt;
}

bool belongs_to(const BatchRun& run, const std::string& sequence, const traces::ImageSize& size,
                const std::string& profile) {
  return run.sequence->name == sequence && run.request.profile == profile &&
         run.request.image_size.width == size.width && run.request.image_size.height == size.height;
}

/// The mean of a figure over rows; none if one of them has none.
template <class Get>
std::optional<double> mean_over(const std::vector<const AblationRow*>& rows, Get get) {
  double sum = 0;
  for (const AblationRow* row : rows) {
    const std::optional<double> value = get(*row);
    if (!value) return std::nullopt;
    sum += *value;
  }
  return sum / static_cast<double>(rows.size());
}

AblationRow mean_row(const std::vector<AblationRow>& all, const traces::ImageSize& size,
                     const std::string& profile) {
  AblationRow mean;
  mean.size = size;
  mean.profile = profile;
  std::vector<const AblationRow*> rows;
  for (const AblationRow& row : all) {
    if (row.profile != profile || row.size.width != size.width || row.size.height != size.height)
      continue;
    rows.push_back(&row);
    mean.ate.runs += row.ate.runs;
    mean.ate.failed += row.ate.failed;
    mean.relative.runs += row.relative.runs;
  }
  mean.ate.median = mean_over(rows, [](const AblationRow& r) { return r.ate.median; });
  mean.relative.median = mean_over(rows, [](const AblationRow& r) { return r.relative.median; });
  mean.paper_ate = mean_over(rows, [](const AblationRow& r) { return r.paper_ate; });
  mean.paper_relative = mean_over(rows, [](const AblationRow& r) { return r.paper_relative; });
  return mean;
}

}  // namespace

std::vector<BatchRun> ablation_runs(const BatchPlan& plan) {
  std::vector<BatchRun> runs;
  for (const std::string& name : sequence_names(plan))
    for (const traces::ImageSize& size : plan.sizes)
      for (const std::string& profile : plan.profiles)
        for (const Sequence& sequence : plan.sequences)
          for (const std::uint32_t seed : plan.seeds)
            if (sequence.name == name)
              runs.push_back(make_run(plan, sequence, profile, size, seed));
  return runs;
}

AblationRow row_of(const std::string& sequence, const traces::ImageSize& size,
                   const std::string& profile, const std::vector<BatchRun>& runs,
                   const std::vector<RunOutcome>& outcomes) {
  AblationRow row{sequence, size, profile, {}, {}, {}, {}, {}, {}};
  std::vector<std::optional<double>> ate;
  std::vector<std::optional<double>> relative;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (!belongs_to(runs[i], sequence, size, profile)) continue;
    const RunOutcome& o = outcomes[i];
    ate.push_back(o.ate_m);
    const bool failed = !o.failure.empty();
    if (failed || o.relative_percent) relative.push_back(o.relative_percent);
    if (failed) continue;
    row.least_completion = std::min(row.least_completion.value_or(o.completion), o.completion);
    if (std::find(row.protocols.begin(), row.protocols.end(), o.protocol) == row.protocols.end())
      row.protocols.push_back(o.protocol);
  }
  row.ate = spread_of(ate);
  row.relative = spread_of(relative);
  return row;
}

std::vector<AblationRow> ablation_rows(const BatchPlan& plan, const std::vector<BatchRun>& runs,
                                       const std::vector<RunOutcome>& outcomes,
                                       const std::vector<PaperAccuracy>& paper) {
  const std::vector<std::string> sequences = sequence_names(plan);
  std::vector<AblationRow> rows;
  for (const std::string& sequence : sequences)
    for (const traces::ImageSize& size : plan.sizes)
      for (const std::string& profile : plan.profiles) {
        AblationRow row = row_of(sequence, size, profile, runs, outcomes);
        row.paper_ate = paper_value(paper, row, Figure::ate);
        if (plan.measure.length_m == kPaperLengthM)
          row.paper_relative = paper_value(paper, row, Figure::relative);
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
