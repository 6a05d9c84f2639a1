#include "tools/app/table/json.h"

#include <algorithm>
#include <cmath>

#include "sim/base/interruption.h"
#include "sim/base/text.h"

namespace leviosim::tools {

std::string json_text(const Json& json, int indent) {
  std::string text = json.dump(indent, ' ', false, Json::error_handler_t::replace);
  // Servers of CI obey "##[error]" wherever it stands; it can only stand in a string.
  std::string safe;
  safe.reserve(text.size());
  for (std::size_t from = 0; from < text.size();) {
    throw_if_interrupted();
    const std::size_t at = std::min(text.find("##", from), text.size());
    safe.append(text, from, at - from);
    if (at < text.size()) safe += "#\\u0023";
    from = at + 2;
  }
  return printable_json(safe);
}

Json value_of(std::optional<double> value) { return value ? Json(*value) : Json(nullptr); }

Json rounded(double value) { return std::round(value * 1e9) / 1e9; }

}  // namespace leviosim::tools
