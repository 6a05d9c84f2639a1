#include "tools/app/validation/microbench/report.h"

#include <fmt/format.h>

#include <cmath>

#include "sim/base/csv_table.h"
#include "tools/app/report/text_table.h"

namespace leviosim::tools {
namespace {

std::string number(double value) { return fmt::format("{:.5g}", value); }

std::string reference_of(const MicrobenchRow& row) {
  if (row.reference == row.reference_high) return number(row.reference);
  return fmt::format("{} … {}", number(row.reference), number(row.reference_high));
}

/// With a mark where the reference lies outside.
std::string band_of(const MicrobenchRow& row) {
  if (!row.band) return {};
  return fmt::format("{} … {}{}", number(row.band->low), number(row.band->high),
                     row.is_inside() ? "" : " !");
}

std::string error_of(const MicrobenchRow& row) {
  return fmt::format("{:+.1f}{}", 100 * row.error(), row.met() ? "" : " !");
}

/// Empty unless the row is worse than it may be.
std::string warning_of(const MicrobenchRow& row) {
  if (row.verdict() != Verdict::Worse) return {};
  return fmt::format("warning: {}, {}, cores {}: error {:+.1f} %, beyond its {} of {:g} %\n",
                     row.group, row.name, row.cores, 100 * row.error(),
                     row.guard ? "guard" : "tolerance", 100 * row.guard.value_or(row.tolerance));
}

TextTable empty_table() {
  using Align = TextTable::Align;
  return TextTable({{"", Align::Left},
                    {"cores"},
                    {"unit", Align::Left, 1},
                    {"reference"},
                    {"simulated"},
                    {"band", Align::Right, 1},
                    {"error %"},
                    {"source", Align::Left, 2}});
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
                 number(row.simulated), band_of(row), error_of(row), row.source});
    }
    text += fmt::format("{}\n{}\n", group, table.str());
    begin = end;
  }
  text += fmt::format("{}: {} of {} rows within their tolerance, mean absolute error {:.1f} %\n",
                      chip, met, rows.size(), 100 * mean_error(rows));
  for (const MicrobenchRow& row : rows) text += warning_of(row);
  return text;
}

std::string coverage_text(const std::vector<MicrobenchRow>& rows,
                          const std::vector<double>& needed) {
  int all = 0;
  int inside = 0;
  for (const MicrobenchRow& row : rows) {
    all += row.band ? 1 : 0;
    inside += row.is_inside() ? 1 : 0;
  }
  const auto at = [&](double share) {
    return needed[static_cast<std::size_t>(
        std::lround(share * static_cast<double>(needed.size() - 1)))];
  };
  std::string text = fmt::format(
      "published cycles of kernels: {} of {} lie inside the band that the platform's ranges "
      "leave\n",
      inside, all);
  if (needed.empty()) return text;
  return text +
         fmt::format(
             "isa.unmeasured_instructions with which one core takes what is published: "
             "{:.2f} to {:.2f} for\n{} kernels, median {:.2f}, the middle four fifths {:.2f} "
             "to {:.2f}\n",
             needed.front(), needed.back(), needed.size(), at(0.5), at(0.1), at(0.9));
}

std::string microbench_conclusion(const std::vector<MicrobenchRow>& rows) {
  std::string worse;
  std::size_t met = 0;
  for (const MicrobenchRow& row : rows) {
    met += row.met();
    if (worse.empty() && row.verdict() == Verdict::Worse)
      worse = fmt::format("{}, {}, cores {}: error {:+.1f} %", row.group, row.name, row.cores,
                          100 * row.error());
  }
  const std::string text =
      fmt::format("{} of {} rows within their tolerance", met, rows.size());
  return worse.empty() ? fmt::format("verdict: met: {}, no other beyond its guard", text)
                       : fmt::format("verdict: NOT met: {}; {}", text, worse);
}

std::string microbench_csv(const std::vector<MicrobenchRow>& rows) {
  using R = MicrobenchRow;
  const auto all_digits = [](double value) { return fmt::format("{}", value); };
  const base::CsvTable<R> table{
      {"group", [](const R& r) { return r.group; }},
      {"name", [](const R& r) { return r.name; }},
      {"cores", [](const R& r) { return r.cores; }},
      {"unit", [](const R& r) { return r.unit; }},
      {"reference", [=](const R& r) { return all_digits(r.reference); }},
      {"reference_high", [=](const R& r) { return all_digits(r.reference_high); }},
      {"simulated", [=](const R& r) { return all_digits(r.simulated); }},
      {"low", [=](const R& r) { return r.band ? all_digits(r.band->low) : std::string(); }},
      {"high", [=](const R& r) { return r.band ? all_digits(r.band->high) : std::string(); }},
      {"error", [=](const R& r) { return all_digits(r.error()); }},
      {"tolerance", [=](const R& r) { return all_digits(r.tolerance); }},
      {"guard", [=](const R& r) { return r.guard ? all_digits(*r.guard) : std::string(); }},
      {"verdict", [](const R& r) { return std::string(name_of(r.verdict())); }},
      {"tier", [](const R& r) { return r.tier; }},
      {"source", [](const R& r) { return r.source; }}};
  return table.text(rows);
}

}  // namespace leviosim::tools
