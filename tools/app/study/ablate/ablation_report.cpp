#include "tools/app/study/ablate/ablation_report.h"

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <map>
#include <memory>

#include "sim/base/printable.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/cli/printout.h"
#include "tools/app/cli/version.h"
#include "tools/app/study/ablate/ablation.h"
#include "tools/app/study/ablate/published_accuracy.h"
#include "tools/app/study/accuracy_study.h"
#include "tools/app/study/finished_runs.h"
#include "tools/app/table/table_files.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {
namespace {

constexpr const char* kMean = "mean of them";

std::string median_text(const Spread& spread, int count) {
  if (spread.runs == 0) return kNothing;
  return error_text(spread.median, count);
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
  return fmt::format("{} … {}", figure_text(spread.low, count), error_text(spread.high, count));
}

Table ablation_table(const BatchPlan& plan, const std::vector<AblationRow>& rows) {
  using R = const AblationRow&;
  return table_of(
      Columns<AblationRow>{
          {{"sequence", kLeft}, [](R r) { return r.sequence.empty() ? kMean : r.sequence; }},
          {{"images", kRight, 1}, [](R r) { return size_text(r.size); }},
          {{"profile", kLeft}, [](R r) { return r.profile; }},
          {{"runs", kRight, 3}, [](R r) { return r.ate.runs; }},
          {{"absolute [m]"}, [](R r) { return median_text(r.ate, 3); }},
          {{"least … greatest", kRight, 2}, [](R r) { return range_text(r, r.ate, 3); }},
          {{"paper", kRight, 2}, [](R r) { return paper_text(r.paper_ate, r, 3); }},
          {{fmt::format("relative, {:g} m [%]", plan.measure.length_m)},
           [](R r) { return median_text(r.relative, 2); }},
          {{"least … greatest", kRight, 2}, [](R r) { return range_text(r, r.relative, 2); }},
          {{"paper", kRight, 2}, [](R r) { return paper_text(r.paper_relative, r, 2); }},
          {{"completion", kRight, 1},
           [](R r) {
             return r.least_completion ? fmt::format("{:.1f} %", 100 * *r.least_completion)
                                       : kNothing;
           }}},
      rows);
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
  return {{"unit", unit},
          {"runs", spread.runs},
          {"failed", spread.failed},
          {"median", figure_json(spread.median)},
          {"low", figure_json(spread.low)},
          {"high", figure_json(spread.high)},
          {"paper", paper_json(paper)}};
}

/// A row of the table: an estimator with images of a size, and its errors by sequence.
struct Estimator {
  std::string name;
  std::string images;
  std::string loop_closure;
  std::map<std::string, std::string> errors{};
};

/// The estimator among the rows, which it is added to if it is new.
Estimator& row_for(std::vector<Estimator>& table, const Estimator& wanted) {
  const auto it = std::find_if(table.begin(), table.end(), [&](const Estimator& e) {
    return e.name == wanted.name && e.images == wanted.images &&
           e.loop_closure == wanted.loop_closure;
  });
  return it != table.end() ? *it : table.emplace_back(wanted);
}

std::string metres(double value) { return fmt::format("{:.2f}", value); }

/// The row with the least absolute error, in a sentence.
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
  return markdown_table(ablation_table(plan, rows)) + '\n' + notes(plan, rows, "- ");
}

void run(const CLI::App& command, const BatchWords& words, const Words& command_line) {
  const BatchPlan plan = make_plan(command, words);
  const std::vector<Point> runs = ablation_runs(plan);
  const std::vector<RunOutcome> outcomes = run_outcomes(runs, plan.measure, plan.runner);
  const std::vector<AblationRow> rows = ablation_rows(plan, runs, outcomes, published_accuracy());
  const Printout text = printout(
      words.json,
      [&] {
        return Printout({fmt::format("leviosim {}: {} native runs\n{}", version(), runs.size(),
                                     ablation_text(plan, rows)),
                         accuracy_comparison(plan, rows, published_accuracy())})
            .ending(ablation_conclusion(rows), after_batch(plan));
      },
      [&] { return json_text(ablation_json(plan, rows), 2) + '\n'; });
  publish(*plan.out, text, [&] {
    plan.out->write("runs.csv", csv_text(run_rows(runs, outcomes, plan.measure)));
    plan.out->write("table.md", ablation_markdown(plan, rows));
    plan.out->write("table.json", json_text(ablation_json(plan, rows), 2) + '\n');
    plan.out->write("manifest.json", json_text(batch_manifest(plan, command_line), 2) + '\n');
  });
}

}  // namespace

std::string ablation_text(const BatchPlan& plan, const std::vector<AblationRow>& rows) {
  return terminal_text(ablation_table(plan, rows)) + notes(plan, rows, "  ");
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
         {"completion", figure_json(row.least_completion)},
         {"protocols", row.protocols}});
  return document;
}

std::string accuracy_comparison(const BatchPlan& plan, const std::vector<AblationRow>& rows,
                                const std::vector<PublishedAccuracy>& published) {
  std::vector<std::string> sequences = sequence_names(plan);
  std::erase_if(sequences, [&](const std::string& name) {
    return std::none_of(published.begin(), published.end(),
                        [&](const PublishedAccuracy& p) { return p.sequence == name; });
  });
  if (sequences.empty()) return {};
  std::vector<Estimator> table;
  for (const AblationRow& row : rows)
    if (!row.sequence.empty())
      row_for(table, {row.profile + ", here", size_text(row.size), "no"}).errors[row.sequence] =
          error_text(row.ate.median, 2);
  for (const PublishedAccuracy& p : published)
    if (p.is_ate() && (!p.chosen_by || p.estimator == "levio"))
      row_for(table, {p.chosen_by ? "LEVIO" : p.estimator, size_text(p.size),
                      p.closes_loops ? "yes" : "no"})
          .errors[p.sequence] = metres(p.value);
  std::vector<Head> columns{{"absolute [m]", kLeft}, {"images"}, {"loop closure"}};
  for (const std::string& sequence : sequences) columns.push_back({sequence});
  Table text(std::move(columns));
  for (Estimator& row : table) {
    std::vector<Cell> cells{row.name, row.images, row.loop_closure};
    for (const std::string& sequence : sequences)
      cells.push_back(row.errors.count(sequence) > 0 ? row.errors[sequence] : "–");
    text.add(std::move(cells));
  }
  return '\n' + terminal_text(text) +
         "  published: LEVIO's paper, over whole sequences; loop closure takes out the drift\n";
}

Command add_ablate_command(CLI::App& app, const Words& words) {
  CLI::App* command = app.add_subcommand(
      "ablate", "The paper's table of pipeline configurations, over given sequences");
  const auto typed = std::make_shared<BatchWords>();
  add_batch_options(*command, *typed);
  add_examples(*command, {"leviosim ablate --data flight --profile levio,next --size "
                          "160x120,320x240 --seed 1 --relative 0.5 --out ablated"});
  add_json_option(*command, typed->json);
  return {.app = command, .run = [=, &words] { run(*command, *typed, words); }, .goes_on = true};
}

}  // namespace leviosim::tools
