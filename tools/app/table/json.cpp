#include "tools/app/table/json.h"

#include <cmath>

#include "sim/base/text.h"

namespace leviosim::tools {

std::string json_text(const Json& json, int indent) {
  std::string text = json.dump(indent, ' ', false, Json::error_handler_t::replace);
  // Servers of CI obey "##[error]" wherever it stands; it can only stand in a string.
  for (std::size_t at = 0; (at = text.find("##", at)) != std::string::npos;)
    text.replace(at, 2, "#\\u0023");
  return printable_json(text);
}

Json value_of(std::optional<double> value) { return value ? Json(*value) : Json(nullptr); }

Json rounded(double value) { return std::round(value * 1e9) / 1e9; }

}  // namespace leviosim::tools
