#include "tools/app/table/json.h"

#include <algorithm>
#include <cmath>

#include "sim/base/interruption.h"
#include "sim/base/printable.h"

namespace leviosim::tools {
namespace {

std::string on_lines(const Json& json, int levels) {
  if (levels == 0 || !json.is_structured() || json.empty()) return json_text(json);
  std::string text;
  for (const auto& item : json.items()) {
    text += text.empty() ? "\n" : ",\n";
    if (json.is_object()) text += json_text(item.key()) + ": ";
    text += on_lines(item.value(), levels - 1);
  }
  return json.is_object() ? '{' + text + "\n}" : '[' + text + "\n]";
}

}  // namespace

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

void add_member(Json& object, const std::string& name, Json value) {
  object.get_ref<Json::object_t&>().emplace_back(name, std::move(value));
}

Json number_json(std::optional<double> value) {
  constexpr double kExact = 0x1p53;
  if (value && *value == std::floor(*value) && std::abs(*value) < kExact)
    return static_cast<std::int64_t>(*value);
  return value_of(value);
}

std::string json_lines(const Json& document) { return on_lines(document, 2); }

}  // namespace leviosim::tools
