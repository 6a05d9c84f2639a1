#include "tools/app/validation/microbench/reference.h"

#include <algorithm>

#include "sim/base/csv.h"

namespace leviosim::tools {
namespace {

const std::vector<std::string> kColumns = {"group",     "name",           "cores",     "unit",
                                           "reference", "reference_high", "tolerance", "source"};
const std::vector<std::string> kGuardColumns = {"group", "name",  "cores",
                                                "unit",  "guard", "reason"};

}  // namespace

std::vector<MicrobenchRow> reference_rows(const std::string& file, std::string text, int tier) {
  base::CsvReader reader(file, base::Separator::comma, kColumns, std::move(text));
  std::vector<MicrobenchRow> rows;
  while (const base::CsvRow* row = reader.next()) {
    if (row->text(0) == kColumns[0]) continue;  // the header
    MicrobenchRow r;
    r.group = row->text(0);
    r.name = row->text(1);
    r.cores = static_cast<int>(row->number(2));
    r.unit = row->text(3);
    r.reference = row->number(4);
    r.reference_high = row->text(5).empty() ? r.reference : row->number(5);
    r.tolerance = row->number(6);
    r.source = row->text(7);
    r.tier = tier;
    rows.push_back(std::move(r));
  }
  return rows;
}

void take_guards(const std::string& file, std::string text, std::vector<MicrobenchRow>& rows) {
  base::CsvReader reader(file, base::Separator::comma, kGuardColumns, std::move(text));
  while (const base::CsvRow* guard = reader.next()) {
    if (guard->text(0) == kGuardColumns[0]) continue;  // the header
    const auto row = std::find_if(rows.begin(), rows.end(), [&](const MicrobenchRow& r) {
      return r.group == guard->text(0) && r.name.substr(0, r.name.find(',')) == guard->text(1) &&
             r.cores == guard->number(2) && r.unit == guard->text(3);
    });
    if (row == rows.end()) guard->fail(1, "no row of the comparison");
    row->guard = guard->number(4);
    if (!(*row->guard > row->tolerance)) guard->fail(4, "no more than the tolerance of the row");
  }
}

}  // namespace leviosim::tools
