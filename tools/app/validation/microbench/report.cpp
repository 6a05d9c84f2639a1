#include "tools/app/validation/microbench/report.h"

#include <fmt/format.h>

#include "tools/app/report/text_table.h"

namespace leviosim::tools {
namespace {

std::string number(double value) { return fmt::format("{:.5g}", value); }

std::string reference_of(const MicrobenchRow& row) {
  if (row.reference == row.reference_high) return number(row.reference);
  return fmt::format("{} … {}", number(row.reference), number(row.reference_high));
}

std::string error_of(const MicrobenchRow& row) {
  return fmt::format("{:+.1f}{}", 100 * row.error(), row.met() ? "" : " !");
}

TextTable empty_table() {
  using Align = TextTable::Align;
  return TextTable({{"", Align::Left},
                    {"cores"},
                    {"unit", Align::Left},
                    {"reference"},
                    {"simulated"},
                    {"error %"},
                    {"source", Align::Left}});
}

}  // namespace

double mean_error(const std::vector<MicrobenchRow>& rows) {
  double sum = 0;
  for (const MicrobenchRow& row : rows) sum += std::abs(row.error());
  return rows.empty() ? 0 : sum / static_cast<double>(rows.size());
}

std::string microbench_table(std::string_view chip, const std::vector<MicrobenchRow>& rows) {
  std::string text;
  std::size_t met = 0;
  for (std::size_t begin = 0; begin < rows.size();) {
    const std::string& group = rows[begin].group;
    TextTable table = empty_table();
    std::size_t end = begin;
    for (; end < rows.size() && rows[end].group == group; ++end) {
      const MicrobenchRow& row = rows[end];
      met += row.met();
      table.add({row.name, std::to_string(row.cores), row.unit, reference_of(row),
                 number(row.simulated), error_of(row), row.source});
    }
    text += fmt::format("{}\n{}\n", group, table.str());
    begin = end;
  }
  return text +
         fmt::format("{}: {} of {} rows within their tolerance, mean absolute error {:.1f} %\n",
                     chip, met, rows.size(), 100 * mean_error(rows));
}

std::string microbench_csv(const std::vector<MicrobenchRow>& rows) {
  std::string text =
      "group,name,cores,unit,reference,reference_high,simulated,error,tolerance,tier,source\n";
  for (const MicrobenchRow& row : rows)
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", row.group, row.name, row.cores,
                        row.unit, row.reference, row.reference_high, row.simulated, row.error(),
                        row.tolerance, row.tier, row.source);
  return text;
}

}  // namespace leviosim::tools
