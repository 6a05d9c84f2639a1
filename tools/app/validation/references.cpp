#include "tools/app/validation/references.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "sim/base/check.h"
#include "sim/base/text.h"
#include "tools/app/validation/published_files.h"

namespace leviosim::tools {
namespace {

constexpr const char* kFile = "paper.csv";
constexpr std::string_view kMissed = "missed: ";
const std::vector<std::string> kTitles{"name",  "value",  "unit",  "tolerance",
                                       "guard", "status", "source"};
enum Title : std::size_t { kName, kValue, kUnit, kTolerance, kGuard, kStatus, kSource };

double number_in(const base::CsvRow& row, Title column, std::string_view text) {
  double value = 0;
  if (!base::parse_number(text, value)) row.fail(column, "not a finite number");
  return value;
}

Deviation deviation_in(const base::CsvRow& row, Title column) {
  std::string_view text = row.text(column);
  const bool relative = text.ends_with('%');
  if (relative) text.remove_suffix(text.ends_with(" %") ? 2 : 1);
  const Deviation deviation{number_in(row, column, text), relative};
  if (deviation.value < 0) row.fail(column, "not 0 or more");
  return deviation;
}

void read_status(const base::CsvRow& row, Reference& reference) {
  const std::string_view status = row.text(kStatus);
  reference.met = status == "met";
  if (reference.met) {
    if (!row.text(kGuard).empty()) row.fail("is met: expected no guard");
    return;
  }
  if (!status.starts_with(kMissed) || status.size() == kMissed.size())
    row.fail(kStatus, "neither met nor missed: REASON");
  reference.reason = status.substr(kMissed.size());
  const Deviation guard = deviation_in(row, kGuard);
  if (guard.relative != reference.tolerance.relative)
    row.fail("guard and tolerance: expected both in per cent or both in the unit");
  if (!(guard.value > reference.tolerance.value))
    row.fail("guard: expected more than the tolerance of what is missed");
  reference.guard = guard.value;
}

Reference reference_from(const base::CsvRow& row) {
  for (const Title column : {kName, kUnit, kSource})
    if (row.text(column).empty()) row.fail(column, "empty");
  Reference reference;
  reference.name = row.text(kName);
  std::string_view value = row.text(kValue);
  reference.limit = !value.empty() && value.front() == '<';
  if (reference.limit) value.remove_prefix(1);
  reference.value = number_in(row, kValue, value);
  reference.unit = row.text(kUnit);
  reference.tolerance = deviation_in(row, kTolerance);
  if (reference.tolerance.relative && reference.value == 0)
    row.fail("value 0: expected a tolerance in its unit");
  read_status(row, reference);
  reference.source = row.text(kSource);
  return reference;
}

std::string deviation_text(Deviation deviation) {
  return fmt::format("{:.12g}{}", deviation.value, deviation.relative ? " %" : "");
}

/// Rounded up to a tenth of a per cent, or to three digits, so that it holds for what was measured.
double guard_for(const Reference& reference, double error) {
  const double step = reference.tolerance.relative
                          ? 0.1
                          : std::pow(10.0, std::floor(std::log10(std::max(error, 1e-9))) - 2.0);
  double guard = std::ceil(error / step) * step;
  if (guard <= reference.tolerance.value) guard += step;
  return guard;
}

std::string row_text(const base::CsvRow& row, const Reference& reference, double value,
                     const std::string& new_reason) {
  const double error = std::abs(error_of(reference, value));
  std::string guard;
  std::string status = "met";
  if (error > reference.tolerance.value) {
    guard = deviation_text({guard_for(reference, error), reference.tolerance.relative});
    status = fmt::format("{}{}", kMissed, reference.met ? new_reason : reference.reason);
  }
  return fmt::format("{},{},{},{},{},{},{}", row.text(kName), row.text(kValue), row.text(kUnit),
                     row.text(kTolerance), guard, status, row.text(kSource));
}

}  // namespace

std::vector<Reference> parse_references(const std::string& file, std::string_view text) {
  std::vector<Reference> references;
  std::set<std::string> names;
  for_each_row(file, text, kTitles, [&](const base::CsvRow& row) {
    references.push_back(reference_from(row));
    if (!names.insert(references.back().name).second) row.fail(kName, "there twice");
  });
  return references;
}

std::string_view paper_references_text() { return reference_text("paper"); }

std::vector<Reference> paper_references() {
  return parse_references(kFile, paper_references_text());
}

double error_of(const Reference& reference, double value) {
  const double difference = value - reference.value;
  if (reference.limit && difference <= 0) return 0;
  return reference.tolerance.relative ? 100 * difference / std::abs(reference.value) : difference;
}

std::string_view name_of(Verdict verdict) {
  constexpr std::array<std::string_view, 5> kNames{"met", "missed", "worse", "improved",
                                                   "not covered"};
  return kNames[static_cast<std::size_t>(verdict)];
}

Verdict judge(const Reference& reference, std::optional<double> value) {
  if (!value) return Verdict::NotCovered;
  return judge(error_of(reference, *value), reference.tolerance.value, reference.guard);
}

Verdict judge(double error, double tolerance, std::optional<double> guard) {
  const bool within = std::abs(error) <= tolerance;
  if (within) return guard ? Verdict::Improved : Verdict::Met;
  return guard && std::abs(error) <= *guard ? Verdict::Missed : Verdict::Worse;
}

std::string updated_references(const std::string& file, std::string_view text,
                               const std::vector<std::optional<double>>& values,
                               const std::string& new_reason) {
  std::vector<std::string> lines = base::split(text, '\n');
  std::size_t next = 0;
  for_each_row(file, text, kTitles, [&](const base::CsvRow& row) {
    if (const std::optional<double> value = values.at(next++))
      lines[row.line() - 1] = row_text(row, reference_from(row), *value, new_reason);
  });
  check_equal(next, values.size(), "values for the references");
  return fmt::format("{}", fmt::join(lines, "\n"));
}

}  // namespace leviosim::tools
