#include "sim/base/csv.h"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/interruption.h"

namespace leviosim::base {
namespace {

constexpr std::string_view kBlanks = " \t\r\n";
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr std::int64_t kNsPerSecond = 1'000'000'000;
constexpr std::int64_t kMostSeconds = 9'000'000'000;
constexpr std::size_t kDecimals = 9;
constexpr std::size_t kLinesPerPoll = 1024;

std::string_view trim(std::string_view text) {
  const auto first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

/// Long cells are cut, so that a binary file does not flood the message.
std::string quoted(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  if (text.size() <= kLongest) return fmt::format("'{}'", text);
  return fmt::format("'{}...'", text.substr(0, kLongest));
}

bool all_digits(std::string_view text) {
  return text.find_first_not_of("0123456789") == std::string_view::npos;
}

/// Digits to an integer; false if there is none or it does not fit.
bool parse_digits(std::string_view text, std::int64_t& value) {
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && stop == text.data() + text.size();
}

/// Seconds in plain decimal notation to nanoseconds, without rounding through a double. Digits
/// beyond the ninth are dropped.
bool parse_plain_seconds(std::string_view text, std::int64_t& ns) {
  const auto dot = text.find('.');
  const std::string_view whole = text.substr(0, dot);
  std::string decimals(dot == std::string_view::npos ? std::string_view() : text.substr(dot + 1));
  if (!all_digits(whole) || !all_digits(decimals)) return false;
  decimals.resize(kDecimals, '0');
  std::int64_t seconds = 0;
  std::int64_t fraction = 0;
  if (!parse_digits(whole, seconds) || !parse_digits(decimals, fraction)) return false;
  if (seconds >= kMostSeconds) return false;
  ns = seconds * kNsPerSecond + fraction;
  return true;
}

}  // namespace

std::string at_line(const std::filesystem::path& file, std::size_t line) {
  return fmt::format("{} line {}", file.string(), line);
}

std::string read_text_file(const std::filesystem::path& file) {
  return base::read_file(file, base::InputKind::table);
}

bool parse_number(std::string_view text, double& value) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stop == end && std::isfinite(value);
}

double CsvRow::number(std::size_t column) const {
  double value = 0;
  if (!parse_number(cells_[column], value)) fail(column, "not a finite number");
  return value;
}

std::int64_t CsvRow::nanoseconds(std::size_t column) const {
  const std::string_view text = cells_[column];
  std::int64_t value = -1;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end || value < 0 || value > kMostSeconds * kNsPerSecond)
    fail(column, "not a time stamp, which is a non-negative integer of nanoseconds, at most 9e18");
  return value;
}

std::int64_t CsvRow::nanoseconds_from_seconds(std::size_t column) const {
  std::int64_t ns = 0;
  if (parse_plain_seconds(cells_[column], ns)) return ns;
  const double seconds = number(column);
  if (seconds < 0 || seconds > static_cast<double>(kMostSeconds))
    fail(column, "not a time stamp, which is seconds from 0 to 9e9");
  return std::llround(seconds * static_cast<double>(kNsPerSecond));
}

void CsvRow::fail(std::string_view message) const {
  throw InputError(fmt::format("{}: {}", at_line(*file_, line_), message));
}

void CsvRow::fail(std::size_t column, std::string_view message) const {
  throw InputError(fmt::format("{}, column {} ({}): {} is {}", at_line(*file_, line_), column + 1,
                               (*names_)[column], quoted(cells_[column]), message));
}

CsvReader::CsvReader(std::filesystem::path file, Separator separator,
                     std::vector<std::string> names)
    : CsvReader(file, separator, std::move(names), read_text_file(file)) {}

CsvReader::CsvReader(std::filesystem::path file, Separator separator,
                     std::vector<std::string> names, std::string text)
    : file_(std::move(file)),
      separator_(separator),
      names_(std::move(names)),
      text_(std::move(text)) {
  const auto last = text_.find_last_not_of(kBlanks);
  text_.resize(last == std::string::npos ? 0 : last + 1);
  if (std::string_view(text_).substr(0, kByteOrderMark.size()) == kByteOrderMark)
    position_ = kByteOrderMark.size();
  row_.file_ = &file_;
  row_.names_ = &names_;
}

std::string_view CsvReader::next_line() {
  const auto end = std::min(text_.find('\n', position_), text_.size());
  const auto line = std::string_view(text_).substr(position_, end - position_);
  position_ = end + 1;
  if (++line_ % 1024 == 0) throw_if_interrupted();
  return line;
}

void CsvReader::split(std::string_view line) {
  row_.cells_.clear();
  if (separator_ == Separator::blanks) {
    while (!(line = trim(line)).empty()) {
      const auto end = std::min(line.find_first_of(kBlanks), line.size());
      row_.cells_.push_back(line.substr(0, end));
      line.remove_prefix(end);
    }
    return;
  }
  for (;;) {
    const auto comma = line.find(',');
    row_.cells_.push_back(trim(line.substr(0, comma)));
    if (comma == std::string_view::npos) return;
    line.remove_prefix(comma + 1);
  }
}

std::vector<std::string_view> CsvReader::heading() {
  const auto end = std::min(text_.find('\n', position_), text_.size());
  std::string_view line = trim(std::string_view(text_).substr(position_, end - position_));
  if (!line.starts_with('#')) return {};
  line.remove_prefix(1);
  split(line);
  return row_.cells_;
}

bool CsvReader::advance() {
  while (position_ < text_.size()) {
    if (line_ % kLinesPerPoll == 0) throw_if_interrupted();
    const std::string_view line = trim(next_line());
    if (!line.empty() && line.front() == '#') continue;
    row_.line_ = line_;
    if (line.empty()) row_.fail("a blank line between rows");
    split(line);
    return true;
  }
  return false;
}

const CsvRow* CsvReader::next() {
  if (!advance()) return nullptr;
  if (row_.size() != names_.size())
    row_.fail(fmt::format("{} column{} instead of {} ({} ... {})", row_.size(),
                          row_.size() == 1 ? "" : "s", names_.size(), names_.front(),
                          names_.back()));
  return &row_;
}

FirstRow first_row(const std::filesystem::path& file) {
  const std::string text = read_text_file(file);
  const auto look = [&](Separator separator) -> FirstRow {
    CsvReader csv(file, separator, {}, text);
    if (!csv.advance()) throw InputError(fmt::format("{}: holds no row", file.string()));
    return {separator, csv.row_.size(), csv.row_.line()};
  };
  const FirstRow by_commas = look(Separator::comma);
  return by_commas.columns > 1 ? by_commas : look(Separator::blanks);
}

void RisingStamps::add(const CsvRow& row, std::int64_t t_ns) {
  if (!empty_ && t_ns <= last_ns_)
    row.fail(fmt::format("time stamp {} {} that of line {} ({}); stamps must rise", t_ns,
                         t_ns == last_ns_ ? "repeats" : "lies before", last_line_, last_ns_));
  empty_ = false;
  last_ns_ = t_ns;
  last_line_ = row.line();
}

}  // namespace leviosim::base
