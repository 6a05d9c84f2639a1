#include "tools/app/study/ablate/ablation.h"

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <map>
#include <memory>

#include "sim/base/csv.h"
#include "sim/base/text.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/cli/version.h"
#include "tools/app/table/terminal_table.h"
#include "tools/app/validation/references.h"

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

const std::vector<std::string> kColumns{"sequence", "estimator", "loop_closure", "width",
                                        "height",   "chosen_by", "figure",       "value",
                                        "unit",     "source"};
enum Column : std::size_t {
  kSequence,
  kEstimator,
  kLoopClosure,
  kWidth,
  kHeight,
  kChosenBy,
  kFigure,
  kValue,
  kUnit,
  kSource
};

PaperFigure figure_in(const base::CsvRow& row, Column column) {
  if (row.text(column) == "ate") return PaperFigure::ate;
  if (row.text(column) == "relative") return PaperFigure::relative;
  row.fail(column, "no figure; expected ate or relative");
}

PublishedAccuracy accuracy_from(const base::CsvRow& row) {
  const std::string_view loops = row.text(kLoopClosure);
  if (loops != "yes" && loops != "no") row.fail(kLoopClosure, "expected yes or no");
  PublishedAccuracy entry{
      std::string(row.text(kSequence)),
      std::string(row.text(kEstimator)),
      loops == "yes",
      {static_cast<int>(row.number(kWidth)), static_cast<int>(row.number(kHeight))},
      std::nullopt,
      figure_in(row, kFigure),
      row.number(kValue),
      std::string(row.text(kSource))};
  if (!row.text(kChosenBy).empty()) {
    entry.chosen_by = figure_in(row, kChosenBy);
    vio::expect_profile(entry.estimator);
  }
  const std::string_view unit = entry.figure == PaperFigure::ate ? "m" : "%";
  if (row.text(kUnit) != unit)
    row.fail(kUnit, fmt::format("not the unit of this figure; expected {}", unit));
  if (entry.source.empty()) row.fail("has no source");
  return entry;
}

// `leviosim ablate`: the paper's table of pipeline configurations, for any sequences and image
// sizes. Its folder:
//
//   manifest.json   what the batch was made from
//   runs.csv        a row per run
//   table.md        the table that is printed
//   table.json      its rows, with more digits

void run(const CLI::App& command, const BatchWords& words, const Words& command_line) {
  const BatchPlan plan = make_plan(command, words);
  const std::vector<Point> runs = ablation_runs(plan);
  const std::vector<RunOutcome> outcomes = run_outcomes(plan, runs);
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

std::vector<PublishedAccuracy> parse_accuracy(const std::string& file, std::string_view text) {
  std::vector<PublishedAccuracy> entries;
  for_each_row(file, text, kColumns,
               [&](const base::CsvRow& row) { entries.push_back(accuracy_from(row)); });
  return entries;
}

std::vector<PublishedAccuracy> published_accuracy() {
  return parse_accuracy("accuracy.csv", reference_text("accuracy"));
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
