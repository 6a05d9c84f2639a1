#include "tools/app/table/cell.h"

#include <fmt/format.h>

#include <cmath>

#include "tools/app/table/json.h"

namespace leviosim::tools {

/// Only what a JSON number would print alike is one: no "nan", no "+1", no "007".
Cell spelled(std::string_view text) {
  if (text.empty()) return {};
  if (text.find_first_not_of("0123456789+-.e") != std::string_view::npos) return text;
  const Json number = Json::parse(text, nullptr, false);
  if (number.is_number_integer()) return number.get<std::int64_t>();
  return number.is_number() ? Cell(number.get<double>()) : Cell(text);
}

std::string figure_text(std::optional<double> value, int decimals, std::string_view otherwise) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : std::string(otherwise);
}

std::string metres_text(std::optional<double> metres, int decimals, std::string_view otherwise) {
  return metres && !(std::abs(*metres) < kDiverged_m) ? kDiverged
                                                      : figure_text(metres, decimals, otherwise);
}

std::string metres(double metres, int decimals) {
  const std::string text = metres_text(metres, decimals);
  return text == kDiverged ? text : text + " m";
}

}  // namespace leviosim::tools
