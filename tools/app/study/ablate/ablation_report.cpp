#include "tools/app/study/ablate/ablation_report.h"

#include <fmt/core.h>

#include <algorithm>

#include "sim/base/printable_text.h"

#include "tools/app/report/number_text.h"
#include "tools/app/report/text_table.h"

namespace leviosim::tools {
namespace {

constexpr const char* kMean = "mean of them";
constexpr const char* kDiverged = "diverged";

std::string median_text(const Spread& spread, int count) {
  if (spread.runs == 0) return kNothing;
  return figure_text(spread.median, count, kDiverged);
}

/// With the image size if it is another.
std::string paper_text(const std::optional<AblationRow::Paper>& paper, const AblationRow& row,
                       int count) {
  if (!paper) return kNothing;
  const std::string text = figure_text(paper->value, count);
  return size_text(paper->size) == size_text(row.size)
             ? text
             : fmt::format("{} ({})", text, size_text(paper->size));
}

/// Nothing for a mean, whose rows have spreads of their own.
std::string range_text(const AblationRow& row, const Spread& spread, int count) {
  if (row.sequence.empty() || spread.runs == 0 || !spread.low) return kNothing;
  return fmt::format("{} … {}", figure_text(spread.low, count),
                     figure_text(spread.high, count, kDiverged));
}

TextTable table_of(const BatchPlan& plan, const std::vector<AblationRow>& rows) {
  TextTable table({{"sequence", kLeft},
                   {"images", kRight, 1},
                   {"profile", kLeft},
                   {"runs", kRight, 3},
                   {"absolute [m]"},
                   {"least … greatest", kRight, 2},
                   {"paper", kRight, 2},
                   {fmt::format("relative, {:g} m [%]", plan.measure.length_m)},
                   {"least … greatest", kRight, 2},
                   {"paper", kRight, 2},
                   {"completion", kRight, 1}});
  for (const AblationRow& row : rows)
    table.add(
        {row.sequence.empty() ? kMean : row.sequence, size_text(row.size), row.profile,
         fmt::format("{}", row.ate.runs), median_text(row.ate, 3), range_text(row, row.ate, 3),
         paper_text(row.paper_ate, row, 3), median_text(row.relative, 2),
         range_text(row, row.relative, 2), paper_text(row.paper_relative, row, 2),
         row.least_completion ? fmt::format("{:.1f} %", 100 * *row.least_completion) : kNothing});
  return table;
}

std::vector<std::string> protocols_of(const std::string& sequence,
                                      const std::vector<AblationRow>& rows) {
  std::vector<std::string> all;
  for (const AblationRow& row : rows)
    if (row.sequence == sequence)
      for (const std::string& protocol : row.protocols)
        if (std::find(all.begin(), all.end(), protocol) == all.end()) all.push_back(protocol);
  return all;
}

std::string notes(const BatchPlan& plan, const std::vector<AblationRow>& rows,
                  const std::string& bullet) {
  std::string text = fmt::format(
      "{}absolute: {}; medians over seeds and folders of a sequence; completion: the least\n",
      bullet, measure_text(plan.measure));
  if (std::any_of(rows.begin(), rows.end(),
                  [](const AblationRow& row) { return row.paper_ate.has_value(); }))
    text += fmt::format(
        "{}paper: its golden model on recorded images, with the parameters of least absolute error "
        "over its sequences; in brackets the image size, if another\n",
        bullet);
  for (const vio::Assignment& a : plan.workload)
    text += fmt::format("{}in every run: {}\n", bullet, a.text());
  for (const std::string& name : sequence_names(plan))
    for (const std::string& protocol : protocols_of(name, rows))
      text += fmt::format("{}{}: {}\n", bullet, name, protocol);
  return text;
}

Json paper_json(const std::optional<AblationRow::Paper>& paper) {
  if (!paper) return nullptr;
  return {{"value", rounded(paper->value)},
          {"width", paper->size.width},
          {"height", paper->size.height}};
}

Json spread_json(const Spread& spread, std::string_view unit,
                 const std::optional<AblationRow::Paper>& paper) {
  const auto value = [](std::optional<double> v) { return v ? rounded(*v) : Json(nullptr); };
  return {{"unit", unit},
          {"runs", spread.runs},
          {"failed", spread.failed},
          {"median", value(spread.median)},
          {"low", value(spread.low)},
          {"high", value(spread.high)},
          {"paper", paper_json(paper)}};
}

}  // namespace

std::string ablation_text(const BatchPlan& plan, const std::vector<AblationRow>& rows) {
  return table_of(plan, rows).str() + notes(plan, rows, "  ");
}

std::string ablation_conclusion(const std::vector<AblationRow>& rows) {
  const AblationRow* best = nullptr;
  for (const AblationRow& row : rows)
    if (!row.sequence.empty() && row.ate.median &&
        (best == nullptr || *row.ate.median < *best->ate.median))
      best = &row;
  if (best == nullptr) return "verdict: all diverged";
  return fmt::format("in short: {} at {} on {} has the least absolute error, {:.3f} m, of {} rows",
                     best->profile, size_text(best->size), printable(best->sequence),
                     *best->ate.median, rows.size());
}

std::string ablation_markdown(const BatchPlan& plan, const std::vector<AblationRow>& rows) {
  return table_of(plan, rows).markdown() + '\n' + notes(plan, rows, "- ");
}

Json ablation_json(const BatchPlan& plan, const std::vector<AblationRow>& rows) {
  Json document;
  document["format"] = "leviosim ablation";
  document["version"] = 1;
  document["measure"] = measure_text(plan.measure);
  document["rows"] = Json::array();
  for (const AblationRow& row : rows)
    document["rows"].push_back(
        {{"sequence", row.sequence.empty() ? Json(nullptr) : Json(row.sequence)},
         {"width", row.size.width},
         {"height", row.size.height},
         {"profile", row.profile},
         {"ate", spread_json(row.ate, "m", row.paper_ate)},
         {"relative", spread_json(row.relative, "%", row.paper_relative)},
         {"relative_length_m", plan.measure.length_m},
         {"completion", row.least_completion ? rounded(*row.least_completion) : Json(nullptr)},
         {"protocols", row.protocols}});
  return document;
}

}  // namespace leviosim::tools
