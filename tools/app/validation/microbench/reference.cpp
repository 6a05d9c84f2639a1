#include "tools/app/validation/microbench/reference.h"

#include "sim/base/csv.h"

namespace leviosim::tools {
namespace {

const std::vector<std::string> kColumns = {"group",     "name",           "cores",     "unit",
                                           "reference", "reference_high", "tolerance", "source"};

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

}  // namespace leviosim::tools
