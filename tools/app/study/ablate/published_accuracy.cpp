#include "tools/app/study/ablate/published_accuracy.h"

#include <fmt/core.h>

#include "sim/base/csv.h"
#include "tools/app/validation/published_files.h"
#include "workload/vio/parameters.h"
#include "workload/vio/profile.h"

namespace leviosim::tools {
namespace {

using PaperFigure = PublishedAccuracy::Figure;

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

}  // namespace

std::vector<PublishedAccuracy> parse_accuracy(const std::string& file, std::string_view text) {
  std::vector<PublishedAccuracy> entries;
  for_each_row(file, text, kColumns,
               [&](const base::CsvRow& row) { entries.push_back(accuracy_from(row)); });
  return entries;
}

std::vector<PublishedAccuracy> published_accuracy() {
  return parse_accuracy("accuracy.csv", reference_text("accuracy"));
}

}  // namespace leviosim::tools
