#include "tools/app/validation/references.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "sim/base/check.h"
#include "sim/base/error.h"

namespace leviosim::tools {
namespace {

constexpr std::string_view kFile = "paper.csv";
constexpr std::string_view kHeader = "name,value,unit,tolerance,guard,status,source";
constexpr std::string_view kMissed = "missed: ";
constexpr std::size_t kReferenceColumns = 7;

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  for (std::size_t begin = 0;;) {
    const std::size_t end = line.find(',', begin);
    cells.push_back(trimmed(line.substr(begin, end - begin)));
    if (end == std::string_view::npos) return cells;
    begin = end + 1;
  }
}

/// One row as text, with what its faults are called.
class Row {
 public:
  Row(std::string where, std::vector<std::string_view> cells)
      : where_(std::move(where)), cells_(std::move(cells)) {
    if (cells_.size() != kReferenceColumns)
      fail(fmt::format("has {} columns; expected {}: {}", cells_.size(), kReferenceColumns,
                       kHeader));
  }

  [[noreturn]] void fail(std::string_view message) const {
    throw InputError(fmt::format("{}: {}", where_, message));
  }
  std::string_view cell(std::size_t column) const { return cells_[column]; }
  double number(std::string_view text, std::string_view what) const {
    double value = 0;
    if (!base::parse_number(text, value))
      fail(fmt::format("{} '{}': expected a number", what, text));
    return value;
  }
  Deviation deviation(std::size_t column, std::string_view what) const {
    std::string_view text = cells_[column];
    const bool relative = !text.empty() && text.back() == '%';
    if (relative) text = trimmed(text.substr(0, text.size() - 1));
    const Deviation deviation{number(text, what), relative};
    if (deviation.value < 0) fail(fmt::format("{} '{}': expected 0 or more", what, text));
    return deviation;
  }

 private:
  std::string where_;
  std::vector<std::string_view> cells_;
};

void read_status(const Row& row, Reference& reference) {
  const std::string_view status = row.cell(5);
  reference.met = status == "met";
  if (reference.met) {
    if (!row.cell(4).empty()) row.fail("is met: expected no guard");
    return;
  }
  if (status.substr(0, kMissed.size()) != kMissed || status.size() == kMissed.size())
    row.fail(fmt::format("status '{}': expected met, or missed: REASON", status));
  reference.reason = status.substr(kMissed.size());
  const Deviation guard = row.deviation(4, "guard");
  if (guard.relative != reference.tolerance.relative)
    row.fail("guard and tolerance: expected both in per cent or both in the unit");
  if (!(guard.value > reference.tolerance.value))
    row.fail("guard: expected more than the tolerance of what is missed");
  reference.guard = guard.value;
}

Reference reference_from(const Row& row) {
  Reference reference;
  reference.name = row.cell(0);
  if (reference.name.empty()) row.fail("name: is empty");
  std::string_view value = row.cell(1);
  reference.limit = !value.empty() && value.front() == '<';
  if (reference.limit) value.remove_prefix(1);
  reference.value = row.number(value, "value");
  reference.unit = row.cell(2);
  if (reference.unit.empty()) row.fail("unit: is empty");
  reference.tolerance = row.deviation(3, "tolerance");
  if (reference.tolerance.relative && reference.value == 0)
    row.fail("value 0: expected a tolerance in its unit");
  read_status(row, reference);
  reference.source = row.cell(6);
  if (reference.source.empty()) row.fail("source: is empty");
  return reference;
}

/// Calls `visit(line, row)` for every line; `row` is empty for comments, blanks and the header.
void for_each_line(const std::string& file, std::string_view text,
                   const std::function<void(std::string_view, const Row*)>& visit) {
  bool header = false;
  int number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = text.substr(begin, end - begin);
    begin = end + 1;
    ++number;
    const std::string where = fmt::format("{}:{}", file, number);
    const bool is_row = header && !line.empty() && line.front() != '#';
    if (!header && !line.empty() && line.front() != '#') {
      if (line != kHeader)
        throw InputError(fmt::format("{}: expected the header {}", where, kHeader));
      header = true;
    }
    if (is_row) {
      const Row row(where, cells_of(line));
      visit(line, &row);
    } else {
      visit(line, nullptr);
    }
  }
  if (!header) throw InputError(fmt::format("{}: expected the header {}", file, kHeader));
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

std::string row_text(const Row& row, const Reference& reference, double value,
                     const std::string& new_reason) {
  const double error = std::abs(error_of(reference, value));
  std::string guard;
  std::string status = "met";
  if (error > reference.tolerance.value) {
    guard = deviation_text({guard_for(reference, error), reference.tolerance.relative});
    status = fmt::format("{}{}", kMissed, reference.met ? new_reason : reference.reason);
  }
  return fmt::format("{},{},{},{},{},{},{}", row.cell(0), row.cell(1), row.cell(2), row.cell(3),
                     guard, status, row.cell(6));
}

}  // namespace

std::vector<Reference> parse_references(const std::string& file, std::string_view text) {
  std::vector<Reference> references;
  std::set<std::string> names;
  for_each_line(file, text, [&](std::string_view, const Row* row) {
    if (row == nullptr) return;
    references.push_back(reference_from(*row));
    if (!names.insert(references.back().name).second)
      row->fail(fmt::format("'{}' is there twice", references.back().name));
  });
  return references;
}

std::string_view reference_text(std::string_view name) {
  for (const base::BuiltinFile& file : builtin_references())
    if (file.name == name) return file.text;
  check_failed(fmt::format("no reference file {}", name), SourceLine::current());
}

void for_each_row(const std::string& file, std::string_view text,
                  const std::vector<std::string>& titles,
                  const std::function<void(const base::CsvRow&)>& visit) {
  base::CsvReader reader(file, base::Separator::comma, titles, std::string(text));
  const base::CsvRow* row = reader.next();
  for (std::size_t i = 0; row != nullptr && i < titles.size(); ++i)
    if (row->text(i) != titles[i]) row->fail(i, fmt::format("expected the title {}", titles[i]));
  while ((row = reader.next()) != nullptr) visit(*row);
}

std::string_view paper_references_text() { return reference_text("paper"); }

std::vector<Reference> paper_references() {
  return parse_references(std::string(kFile), paper_references_text());
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
  std::string out;
  std::size_t next = 0;
  for_each_line(file, text, [&](std::string_view line, const Row* row) {
    std::string written(line);
    if (row != nullptr) {
      const std::optional<double> value = values.at(next++);
      if (value) written = row_text(*row, reference_from(*row), *value, new_reason);
    }
    out += written + '\n';
  });
  check_equal(next, values.size(), "values for the references");
  return out;
}

}  // namespace leviosim::tools
