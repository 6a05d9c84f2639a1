#include "tools/app/study/ablate/published_accuracy.h"

#include <fmt/core.h>

#include "sim/base/csv.h"
#include "sim/base/text.h"
#include "tools/app/validation/references.h"
#include "workload/vio/profile.h"

namespace leviosim::tools {
namespace {

using Figure = PaperAccuracy::Figure;

constexpr std::string_view kHeader =
    "sequence,profile,width,height,chosen_by,figure,value,unit,source";
/// Columns of the table.
struct PaperColumn {
  enum Index : std::size_t {
    kSequence,
    kProfile,
    kWidth,
    kHeight,
    kChosenBy,
    kFigure,
    kValue,
    kUnit,
    kSource
  };
};

Figure figure_in(const base::CsvRow& row, PaperColumn::Index column) {
  if (row.text(column) == "ate") return Figure::ate;
  if (row.text(column) == "relative") return Figure::relative;
  row.fail(column, "no figure; expected ate or relative");
}

PaperAccuracy paper_accuracy_from(const base::CsvRow& row) {
  PaperAccuracy entry{std::string(row.text(PaperColumn::kSequence)),
                      std::string(row.text(PaperColumn::kProfile)),
                      {static_cast<int>(row.number(PaperColumn::kWidth)),
                       static_cast<int>(row.number(PaperColumn::kHeight))},
                      figure_in(row, PaperColumn::kChosenBy),
                      figure_in(row, PaperColumn::kFigure),
                      row.number(PaperColumn::kValue),
                      std::string(row.text(PaperColumn::kSource))};
  vio::profile_named(entry.profile, 1);
  const std::string_view unit = entry.figure == Figure::ate ? "m" : "%";
  if (row.text(PaperColumn::kUnit) != unit)
    row.fail(PaperColumn::kUnit, fmt::format("not the unit of this figure; expected {}", unit));
  if (entry.source.empty()) row.fail("has no source");
  return entry;
}

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

}  // namespace

std::vector<PaperAccuracy> parse_paper_accuracy(const std::string& file, std::string_view text) {
  const std::vector<std::string> names = base::split(kHeader, ',');
  base::CsvReader reader(file, base::Separator::comma, names, std::string(text));
  const base::CsvRow* header = reader.next();
  for (std::size_t i = 0; header != nullptr && i < names.size(); ++i)
    if (header->text(i) != names[i]) header->fail(fmt::format("expected the header {}", kHeader));
  std::vector<PaperAccuracy> entries;
  while (const base::CsvRow* row = reader.next()) entries.push_back(paper_accuracy_from(*row));
  return entries;
}

std::vector<PaperAccuracy> paper_accuracy() {
  return parse_paper_accuracy("paper_accuracy.csv", reference_text("paper_accuracy"));
}

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

}  // namespace leviosim::tools
