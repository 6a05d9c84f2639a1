#include "tools/app/study/ablate/ablation_table.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>

#include "sim/base/printable.h"
#include "tools/app/study/accuracy_study.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {
namespace {

constexpr const char* kMean = "mean of them";

bool has_paper(const AblationRow& row) { return row.paper_ate || row.paper_relative; }

using PaperOf = std::optional<AblationRow::Paper> AblationRow::*;

/// Median and ends of an error, and the paper's. @param key  "ate", and the unit in files, "m"
void add_error(Columns<AblationRow>& columns, const std::string& title, const std::string& key,
               const std::string& key_unit, const char* unit, int shown, Spread AblationRow::*of) {
  using R = const AblationRow&;
  const auto add = [&](const char* part, const std::string& name, int rank, auto end) {
    columns.push_back({{.title = name,
                        .rank = rank,
                        .shown = shown,
                        .nothing = rank == 0 ? kDiverged : kNothing,
                        .key = key + part + key_unit,
                        .decimals = 9,
                        .unit = unit},
                       [=](R r) { return r.*of.*end; }});
  };
  add("_median_", title, 0, &Spread::median);
  add("_least_", "least", 2, &Spread::low);
  add("_greatest_", "greatest", 2, &Spread::high);
}

void add_paper(Columns<AblationRow>& columns, const std::string& key, int shown, PaperOf of) {
  using R = const AblationRow&;
  columns.push_back({{.title = "paper", .rank = 2, .shown = shown, .key = key, .decimals = 9},
                     [=](R r) { return r.*of ? Cell((r.*of)->value) : Cell(); }});
}

/// What tells the rows apart.
Columns<AblationRow> row_columns(const Ablation& ablation) {
  using R = const AblationRow&;
  Columns<AblationRow> columns{
      {{.title = "sequence", .align = kLeft, .key = "sequence", .is_setup = true},
       [](R r) { return r.sequence.empty() ? kMean : r.sequence; }},
      {{.title = "images", .rank = 1, .key = "images", .is_setup = true},
       [](R r) { return size_text(r.size); }},
      {{.title = "profile", .align = kLeft, .key = "profile", .is_setup = true},
       [](R r) { return r.profile; }}};
  if (ablation.dimensions.empty()) return columns;
  columns.push_back(
      {{.title = "point", .key = "point", .is_setup = true}, [](R r) { return r.point; }});
  for (const Dimension& d : ablation.dimensions)
    columns.push_back(
        {{.title = std::string(d.parameter->name.substr(vio::kParameterPrefix.size())),
          .rank = 1,
          .key = std::string(d.parameter->name),
          .unit = std::string(d.parameter->unit),
          .is_setup = true},
         [&d](R r) { return spelled(value_in(d, r.profile, r.set)); }});
  return columns;
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

/// "levio has its least absolute error, 0.051 m, at point 3; as it is, 0.060 m"; nothing if it
/// diverged at all points.
std::string gain_text(const std::string& profile, const std::vector<AblationRow>& rows) {
  const AblationRow* best = best_row(rows, profile, &AblationRow::ate);
  if (best == nullptr) return {};
  return fmt::format("{} has its least absolute error, {} m, at point {}; as it is, {} m", profile,
                     error_text(best->ate.median, 3), best->point,
                     error_text(row_as_it_is(rows, profile)->ate.median, 3));
}

/// The row with the least absolute error, of those as the profiles are.
std::string least_text(const std::vector<AblationRow>& rows) {
  const AblationRow* best = nullptr;
  for (const AblationRow& row : rows)
    if (!row.sequence.empty() && row.ate.median &&
        (best == nullptr || *row.ate.median < *best->ate.median))
      best = &row;
  if (best == nullptr) return {};
  return fmt::format("{} at {} on {} has the least absolute error, {:.3f} m, of {} rows",
                     best->profile, size_text(best->size), printable(best->sequence),
                     *best->ate.median, rows.size());
}

}  // namespace

Table ablation_table(const Ablation& ablation, const std::vector<AblationRow>& rows) {
  using R = const AblationRow&;
  Columns<AblationRow> columns = row_columns(ablation);
  const bool shows_paper = std::any_of(rows.begin(), rows.end(), has_paper);
  columns.push_back({{.title = "runs", .rank = 3, .key = "runs"}, [](R r) { return r.ate.runs; }});
  columns.push_back(
      {{.title = "diverged", .rank = 3, .key = "diverged"}, [](R r) { return r.ate.failed; }});
  add_error(columns, "absolute [m]", "ate", "m", "m", 3, &AblationRow::ate);
  if (shows_paper) add_paper(columns, "paper_ate_m", 3, &AblationRow::paper_ate);
  add_error(columns, fmt::format("relative, {:g} m [%]", ablation.plan.measure.length_m),
            "relative", "percent", "%", 2, &AblationRow::relative);
  columns[columns.size() - 3].head.nothing = kNothing;  // the path may be too short for any
  if (shows_paper) {
    add_paper(columns, "paper_relative_percent", 2, &AblationRow::paper_relative);
    columns.push_back({{.title = "its images", .rank = 2, .key = "paper_images"}, [](R r) {
                         return r.paper_ate ? Cell(size_text(r.paper_ate->size)) : Cell();
                       }});
  }
  Head completion = completion_head();
  completion.rank = 1;
  completion.shown = 1;
  columns.push_back({completion, [](R r) { return r.least_completion; }});
  return table_of(columns, rows);
}

std::vector<AblationRow> notable_rows(const Ablation& ablation,
                                      const std::vector<AblationRow>& rows) {
  if (ablation.dimensions.empty()) return rows;
  std::vector<AblationRow> notable;
  for (const std::string& profile : ablation.plan.profiles) {
    std::vector<const AblationRow*> of_profile{row_as_it_is(rows, profile)};
    for (const auto by : {&AblationRow::ate, &AblationRow::relative})
      if (const AblationRow* best = best_row(rows, profile, by);
          best != nullptr &&
          std::find(of_profile.begin(), of_profile.end(), best) == of_profile.end())
        of_profile.push_back(best);
    for (const AblationRow* row : of_profile) notable.push_back(*row);
  }
  return notable;
}

std::string ablation_notes(const Ablation& ablation, const std::vector<AblationRow>& rows,
                           const std::string& bullet) {
  std::string text = fmt::format(
      "{}absolute: {}; medians over seeds and folders of a sequence; completion: the least\n",
      bullet, measure_text(ablation.plan.measure));
  if (!ablation.dimensions.empty())
    text += fmt::format(
        "{}of {} points of each profile: as it is (0), and those of least absolute and relative "
        "error\n",
        bullet, ablation.points.size());
  if (std::any_of(rows.begin(), rows.end(), has_paper))
    text += fmt::format(
        "{}paper: its golden model on recorded images, with the parameters of least absolute error "
        "over its sequences\n",
        bullet);
  for (const vio::Assignment& a : ablation.plan.workload)
    text += fmt::format("{}in every run: {}\n", bullet, a.text());
  for (const std::string& name : sequence_names(ablation.plan))
    for (const std::string& protocol : protocols_of(name, rows))
      text += fmt::format("{}{}: {}\n", bullet, name, protocol);
  return text;
}

std::string ablation_conclusion(const Ablation& ablation, const std::vector<AblationRow>& rows) {
  const std::string said = ablation.dimensions.empty()
                               ? least_text(rows)
                               : gain_text(ablation.plan.profiles.front(), rows);
  return said.empty() ? "verdict: all diverged" : "in short: " + said;
}

std::string accuracy_comparison(const Ablation& ablation, const std::vector<AblationRow>& rows,
                                const std::vector<PublishedAccuracy>& published) {
  std::vector<std::string> sequences = sequence_names(ablation.plan);
  std::erase_if(sequences, [&](const std::string& name) {
    return std::none_of(published.begin(), published.end(),
                        [&](const PublishedAccuracy& p) { return p.sequence == name; });
  });
  if (sequences.empty()) return {};
  std::vector<Estimator> table;
  for (const AblationRow& row : rows)
    if (!row.sequence.empty() && row.point == 0)
      row_for(table, {row.profile + ", here", size_text(row.size), "no"}).errors[row.sequence] =
          error_text(row.ate.median, 2);
  for (const PublishedAccuracy& p : published)
    if (p.is_ate() && (!p.chosen_by || p.estimator == "levio"))
      row_for(table, {p.chosen_by ? "LEVIO" : p.estimator, size_text(p.size),
                      p.closes_loops ? "yes" : "no"})
          .errors[p.sequence] = fmt::format("{:.2f}", p.value);
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

StudyPage ablation_page(const Ablation& ablation, const std::vector<AblationRow>& rows) {
  StudyPage page;
  page.title = "Accuracy of profiles and parameters";
  if (!ablation.dimensions.empty())
    for (const std::string& profile : ablation.plan.profiles) {
      StudyBox& box = page.boxes.emplace_back();
      box.mark = profile;
      box.sentence = gain_text(profile, rows);
      if (box.sentence.empty()) box.sentence = "It diverged at all points.";
    }
  page.summary = ablation_notes(ablation, rows, "");
  page.x = "relative_median_percent";
  page.y = "ate_median_m";
  page.colour = "profile";
  return page;
}

}  // namespace leviosim::tools
