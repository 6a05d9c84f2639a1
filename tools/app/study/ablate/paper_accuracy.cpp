#include "tools/app/study/ablate/paper_accuracy.h"

#include <fmt/core.h>

#include "sim/base/csv.h"
#include "tools/app/validation/builtin_references.h"
#include "workload/vio/profile.h"

namespace leviosim::tools {
namespace {

using Figure = PaperAccuracy::Figure;

constexpr std::string_view kHeader =
    "sequence,profile,width,height,chosen_by,figure,value,unit,source";
enum Column : std::size_t {
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

Figure figure_in(const base::CsvRow& row, Column column) {
  if (row.text(column) == "ate") return Figure::ate;
  if (row.text(column) == "relative") return Figure::relative;
  row.fail(column, "no figure; expected ate or relative");
}

PaperAccuracy accuracy_from(const base::CsvRow& row) {
  PaperAccuracy entry{std::string(row.text(kSequence)),
                      std::string(row.text(kProfile)),
                      {static_cast<int>(row.number(kWidth)), static_cast<int>(row.number(kHeight))},
                      figure_in(row, kChosenBy),
                      figure_in(row, kFigure),
                      row.number(kValue),
                      std::string(row.text(kSource))};
  vio::profile_named(entry.profile, 1);
  const std::string_view unit = entry.figure == Figure::ate ? "m" : "%";
  if (row.text(kUnit) != unit)
    row.fail(kUnit, fmt::format("not the unit of this figure; expected {}", unit));
  if (entry.source.empty()) row.fail("has no source");
  return entry;
}

}  // namespace

std::vector<PaperAccuracy> parse_paper_accuracy(const std::string& file, std::string_view text) {
  std::vector<std::string> names;
  for (std::string_view rest = kHeader;;) {
    const std::size_t comma = rest.find(',');
    names.emplace_back(rest.substr(0, comma));
    if (comma == std::string_view::npos) break;
    rest.remove_prefix(comma + 1);
  }
  base::CsvReader reader(file, base::Separator::comma, names, std::string(text));
  const base::CsvRow* header = reader.next();
  for (std::size_t i = 0; header != nullptr && i < names.size(); ++i)
    if (header->text(i) != names[i]) header->fail(fmt::format("expected the header {}", kHeader));
  std::vector<PaperAccuracy> entries;
  while (const base::CsvRow* row = reader.next()) entries.push_back(accuracy_from(*row));
  return entries;
}

std::vector<PaperAccuracy> paper_accuracy() {
  return parse_paper_accuracy("paper_accuracy.csv", reference_text("paper_accuracy"));
}

}  // namespace leviosim::tools
