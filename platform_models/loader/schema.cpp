#include "platform_models/loader/schema.h"

#include <fmt/format.h>

#include <charconv>
#include <system_error>

#include "platform_models/loader/fields.h"
#include "sim/base/check.h"
#include "sim/base/text.h"

namespace leviosim::platform {

Schema::Schema() : fields_(all_fields()) {
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    const Field& field = fields_[i];
    check(by_path_.emplace(field.path, i).second, "a parameter is described twice");
    by_record_[field.record].push_back(i);
    for (std::size_t dot = field.record.find('.'); dot != std::string::npos;
         dot = field.record.find('.', dot + 1))
      sections_.insert(field.record.substr(0, dot));
  }
}

std::size_t Schema::find(std::string_view path) const {
  const auto found = by_path_.find(path);
  return found == by_path_.end() ? kNone : found->second;
}

bool Schema::is_section(std::string_view path) const { return sections_.count(path) > 0; }

std::vector<std::size_t> Schema::record(std::string_view path) const {
  const auto found = by_record_.find(path);
  return found == by_record_.end() ? std::vector<std::size_t>{} : found->second;
}

std::vector<std::string> Schema::paths() const {
  std::vector<std::string> paths;
  for (const Field& field : fields_) paths.push_back(field.path);
  return paths;
}

std::vector<std::string> Schema::keys() const {
  std::vector<std::string> keys(sections_.begin(), sections_.end());
  for (const auto& [record, fields] : by_record_) keys.push_back(record);
  return keys;
}

std::string why_unknown(const std::string& path, const std::vector<std::string>& known) {
  if (path.ends_with(".instruction_overhead"))
    return "no such key any more: compiled code is taken as it was measured; delete it";
  return "unknown key" + base::did_you_mean(path, known);
}

const Unit* Dimension::find(std::string_view name) const {
  for (const Unit& unit : units)
    if (unit.name == name) return &unit;
  return nullptr;
}

std::string Dimension::unit_names() const {
  std::string names;
  for (const Unit& unit : units) {
    if (!names.empty()) names += ", ";
    names += unit.name;
  }
  return names;
}

std::string_view trim(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlank) - begin + 1);
}

std::optional<Measure> split_measure(std::string_view text) {
  text = trim(text);
  double number = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc{}) return std::nullopt;
  const auto length = static_cast<std::size_t>(rest - text.data());
  return Measure{number, trim(text.substr(length))};
}

std::optional<double> parse_number(std::string_view text) {
  const std::optional<Measure> measure = split_measure(text);
  if (!measure || !measure->unit.empty()) return std::nullopt;
  return measure->number;
}

std::string number_text(double number) { return fmt::format("{}", number); }

}  // namespace leviosim::platform
