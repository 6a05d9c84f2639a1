#include "tools/app/study/ablate/other_accuracy.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <set>

#include "sim/base/csv.h"
#include "tools/app/report/text_table.h"
#include "tools/app/validation/builtin_references.h"

namespace leviosim::tools {
namespace {

const std::vector<std::string> kColumns{"sequence", "estimator", "loop_closure", "width",
                                        "height",   "value",     "unit",         "source"};
enum Column : std::size_t {
  kSequence,
  kEstimator,
  kLoopClosure,
  kWidth,
  kHeight,
  kValue,
  kUnit,
  kSource
};

OtherAccuracy accuracy_from(const base::CsvRow& row) {
  const std::string loops(row.text(kLoopClosure));
  if (loops != "yes" && loops != "no") row.fail(kLoopClosure, "expected yes or no");
  if (row.text(kUnit) != "m") row.fail(kUnit, "expected m");
  if (row.text(kSource).empty()) row.fail("has no source");
  return {std::string(row.text(kSequence)),
          std::string(row.text(kEstimator)),
          loops == "yes",
          {static_cast<int>(row.number(kWidth)), static_cast<int>(row.number(kHeight))},
          row.number(kValue),
          std::string(row.text(kSource))};
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

}  // namespace

std::vector<OtherAccuracy> parse_other_accuracy(const std::string& file, std::string_view text) {
  base::CsvReader reader(file, base::Separator::comma, kColumns, std::string(text));
  const base::CsvRow* header = reader.next();
  for (std::size_t i = 0; header != nullptr && i < kColumns.size(); ++i)
    if (header->text(i) != kColumns[i])
      header->fail(i, fmt::format("expected the title {}", kColumns[i]));
  std::vector<OtherAccuracy> entries;
  while (const base::CsvRow* row = reader.next()) entries.push_back(accuracy_from(*row));
  return entries;
}

std::vector<OtherAccuracy> other_accuracy() {
  return parse_other_accuracy("other_accuracy.csv", reference_text("other_accuracy"));
}

std::string accuracy_comparison(const BatchPlan& plan, const std::vector<AblationRow>& rows,
                                const std::vector<PaperAccuracy>& paper,
                                const std::vector<OtherAccuracy>& others) {
  std::set<std::string> published;
  for (const OtherAccuracy& other : others) published.insert(other.sequence);
  std::vector<std::string> sequences = sequence_names(plan);
  std::erase_if(sequences, [&](const std::string& name) { return published.count(name) == 0; });
  if (sequences.empty()) return {};
  std::vector<Estimator> table;
  for (const AblationRow& row : rows)
    if (!row.sequence.empty())
      row_for(table, {row.profile + ", here", size_text(row.size), "no"}).errors[row.sequence] =
          row.ate.median ? metres(*row.ate.median) : "diverged";
  for (const PaperAccuracy& p : paper)
    if (p.profile == "levio" && p.figure == PaperAccuracy::Figure::ate &&
        p.chosen_by == PaperAccuracy::Figure::ate)
      row_for(table, {"LEVIO", size_text(p.size), "no"}).errors[p.sequence] = metres(p.value);
  for (const OtherAccuracy& other : others)
    row_for(table, {other.estimator, size_text(other.size), other.closes_loops ? "yes" : "no"})
        .errors[other.sequence] = metres(other.ate_m);
  std::vector<TextTable::Column> columns{
      {"absolute [m]", TextTable::Align::Left}, {"images"}, {"loop closure"}};
  for (const std::string& sequence : sequences) columns.push_back({sequence});
  TextTable text(std::move(columns));
  for (Estimator& row : table) {
    std::vector<std::string> cells{row.name, row.images, row.loop_closure};
    for (const std::string& sequence : sequences)
      cells.push_back(row.errors.count(sequence) > 0 ? row.errors[sequence] : "–");
    text.add(std::move(cells));
  }
  return '\n' + text.str() +
         "  published: LEVIO's paper, over whole sequences; loop closure takes out the drift\n";
}

}  // namespace leviosim::tools
