#include "platform_models/loader/parameter_units.h"

#include <fmt/format.h>

#include <charconv>
#include <system_error>

namespace leviosim::platform {

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
