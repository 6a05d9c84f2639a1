#include "platform_models/loader/value.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "platform_models/loader/parameter.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"

namespace leviosim::platform {
namespace {

// A product such as 0.3 GHz · 1e9 may miss the whole number that was meant by rounding.
constexpr double kRounding = 1e-12;

double read_number(std::string_view text, const Place& place) {
  const std::optional<double> number = parse_number(text);
  if (!number) place.fail(fmt::format("'{}' is not a number", text));
  if (!std::isfinite(*number)) place.fail(fmt::format("'{}' is not a finite number", text));
  return *number;
}

const Unit& find_unit(const Field& field, std::string_view name, const Place& place) {
  const Dimension& dimension = *field.dimension;
  const Unit* unit = dimension.find(name);
  if (unit == nullptr)
    place.fail(fmt::format("'{}' is no unit of {}; expected {}{}", name, dimension.meaning,
                           dimension.units.size() > 1 ? "one of " : "", dimension.unit_names()));
  return *unit;
}

/// In base units, checked against the field's limits.
double to_base(const Field& field, double number, const Unit& unit, const Place& place) {
  double base = number * unit.factor;
  if (!(base >= field.min && base <= field.max))
    place.fail(fmt::format("{} {} is out of range; expected {} to {} {}", number, unit.name,
                           field.min / unit.factor, field.max / unit.factor, unit.name));
  if (!field.dimension->whole) return base;
  const double whole = std::round(base);
  if (std::abs(base - whole) > kRounding * whole)
    place.fail(fmt::format("{} {} is no whole number of {}", number, unit.name,
                           field.dimension->units[0].name));
  return whole;
}

Setting read_choice(const Field& field, std::string_view text, const Place& place) {
  Setting setting;
  setting.parameter.value = std::string(text);
  for (std::size_t i = 0; i < field.choices.size(); ++i) {
    if (field.choices[i] != text) continue;
    setting.base = static_cast<double>(i);
    return setting;
  }
  place.fail(fmt::format("'{}' is not known; expected one of {}{}", text,
                         fmt::join(field.choices, ", "), base::did_you_mean(text, field.choices)));
}

}  // namespace

void Place::fail(std::string_view message) const {
  throw InputError(fmt::format("{}: {}", where, message));
}

void check_unit(const Field& field, std::string_view unit, const Place& place) {
  find_unit(field, unit, place);
}

Setting read_value(const Field& field, std::string_view text, std::string_view unit,
                   const Place& place) {
  Setting setting;
  if (field.is_choice()) {
    setting = read_choice(field, text, place);
  } else {
    const Unit& known = find_unit(field, unit, place);
    const double number = read_number(text, place);
    setting.base = to_base(field, number, known, place);
    setting.parameter.value = number_text(number);
    setting.parameter.unit = std::string(known.name);
  }
  setting.parameter.path = field.path;
  setting.parameter.description = field.description;
  return setting;
}

Range read_range(const Field& field, const Setting& value, std::string_view low,
                 std::string_view high, const Place& place) {
  const Unit& unit = find_unit(field, value.parameter.unit, place);
  const Range range{read_number(low, place), read_number(high, place)};
  const double base_low = to_base(field, range.low, unit, place);
  const double base_high = to_base(field, range.high, unit, place);
  if (!(base_low <= value.base && value.base <= base_high))
    place.fail(fmt::format("the range {} to {} does not contain the value {}", range.low,
                           range.high, value.parameter.value));
  return range;
}

}  // namespace leviosim::platform
