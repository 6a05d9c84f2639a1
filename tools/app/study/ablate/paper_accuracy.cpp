#include "tools/app/study/ablate/paper_accuracy.h"

#include <fmt/core.h>

#include "sim/base/csv.h"
#include "sim/base/text.h"
#include "tools/app/validation/builtin_references.h"
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

}  // namespace leviosim::tools
