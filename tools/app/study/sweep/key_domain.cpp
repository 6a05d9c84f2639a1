#include "tools/app/study/sweep/key_domain.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "sim/base/check.h"
#include "tools/app/study/sweep/sweep_key.h"

namespace leviosim::tools {
namespace {

using Kind = SweepKey::Kind;

using platform::Place;

using platform::YamlEntry;

constexpr double kMostSteps = 1e6;

double to_digits(double value, int digits) {
  return platform::parse_number(fmt::format("{:.{}g}", value, digits)).value_or(value);
}

bool is_whole(const SweepKey& key, const platform::Schema& schema) {
  if (key.kind == SweepKey::Kind::chip)
    return schema.fields()[schema.find(key.path)].dimension->whole;
  return key.parameter == nullptr || key.parameter->kind != vio::Parameter::Kind::number;
}

class RangeReader {
 public:
  RangeReader(const SweepKey& key, YamlMap map, platform::PlatformFile& reference)
      : key_(key), map_(std::move(map)), reference_(reference) {}

  Domain read(const Place& place) const {
    if (!key_.is_number(reference_.schema()))
      place.fail("has no range, as it is no number; expected a list of values");
    map_.check_keys({"from", "to", "step", "scale"});
    const SweepNumber low = number("from", place);
    const SweepNumber high = number("to", place);
    if (!(low.value < high.value)) place.fail("expected from below to");
    const YamlEntry* step = map_.find("step");
    const YamlEntry* scale = map_.find("scale");
    if (step != nullptr && scale != nullptr) place.fail("has step and scale; expected one of them");
    if (step != nullptr) return steps(low, high, *step);
    if (scale != nullptr && map_.text(*scale) == "powers_of_two")
      return powers_of_two(low, high, map_.place(*scale));
    return {{},
            Span{low.value, high.value, is_logarithmic(scale, low, place),
                 is_whole(key_, reference_.schema()), low.factor, low.unit}};
  }

 private:
  SweepNumber number(const char* name, const Place& at) const {
    const YamlEntry* entry = map_.find(name);
    if (entry == nullptr) at.fail(fmt::format("missing key '{}'", name));
    return number_of(key_, map_.text(*entry), reference_, map_.place(*entry));
  }
  bool is_logarithmic(const YamlEntry* scale, const SweepNumber& low, const Place& at) const {
    if (scale == nullptr) return false;
    const std::string text = map_.text(*scale);
    if (text != "log" && text != "linear")
      map_.place(*scale).fail(
          fmt::format("'{}' is not known; expected linear, log or powers_of_two", text));
    if (text == "log" && !(low.value > 0)) at.fail("a log scale begins above 0");
    return text == "log";
  }
  /// A step has the unit of the range; it may be smaller than any valid value.
  double step_size(const YamlEntry& entry, const SweepNumber& low) const {
    const Place at = map_.place(entry);
    const std::string text = map_.text(entry);
    const std::optional<platform::Measure> measure = platform::split_measure(text);
    if (!measure || !(measure->number > 0)) at.fail(fmt::format("'{}' is no number above 0", text));
    if (measure->unit.empty() || measure->unit == low.unit) return measure->number;
    const platform::Schema& schema = reference_.schema();
    const platform::Unit* unit =
        key_.kind == SweepKey::Kind::chip
            ? schema.fields()[schema.find(key_.path)].dimension->find(measure->unit)
            : nullptr;
    if (unit == nullptr) at.fail(fmt::format("'{}' is no unit of {}", measure->unit, key_.name));
    return measure->number * unit->factor / low.factor;
  }
  Domain steps(const SweepNumber& low, const SweepNumber& high, const YamlEntry& entry) const {
    const double step = step_size(entry, low);
    constexpr double kRounding = 1e-9;
    const double count = std::floor((high.value - low.value) / step + kRounding) + 1;
    if (count > kMostSteps)
      map_.place(entry).fail(
          fmt::format("gives {:g} values; expected at most {:g}", count, kMostSteps));
    Domain domain;
    for (int k = 0; k < static_cast<int>(count); ++k) {
      SweepNumber value = low;
      value.value = to_digits(low.value + k * step, 12);
      domain.values.push_back(normal_value(key_, value.text(), reference_, map_.place(entry)));
    }
    return domain;
  }

  /// Those of base units, such as bytes: sizes that exist.
  Domain powers_of_two(const SweepNumber& low, const SweepNumber& high, const Place& at) const {
    Domain domain;
    for (double base = 1; base <= high.value * low.factor; base *= 2) {
      if (base < low.value * low.factor) continue;
      SweepNumber value = low;
      value.value = base / low.factor;
      domain.values.push_back(normal_value(key_, value.text(), reference_, at));
    }
    if (domain.values.empty()) at.fail("the range holds no power of two");
    return domain;
  }

  const SweepKey& key_;
  YamlMap map_;
  platform::PlatformFile& reference_;
};

}  // namespace

Domain read_domain(const SweepKey& key, const YamlMap& map, const YamlMap::Entry& entry,
                   platform::PlatformFile& reference) {
  const Place place = map.place(entry);
  const platform::YamlNode& node = entry.value;
  if (node.is_mapping()) return RangeReader(key, map.below(entry), reference).read(place);
  Domain domain;
  const auto add = [&](const platform::YamlNode& value) {
    domain.values.push_back(normal_value(key, platform::scalar(value, place), reference, place));
  };
  if (!node.is_sequence()) {
    add(node);
    return domain;
  }
  for (const platform::YamlNode& value : node.items()) add(value);
  if (domain.values.empty()) place.fail("is an empty list; expected values");
  return domain;
}

std::string value_at(const Domain& domain, double u) {
  check(u >= 0 && u < 1, "a place in a domain");
  if (!domain.span) {
    const auto count = static_cast<double>(domain.values.size());
    return domain.values[static_cast<std::size_t>(u * count)];
  }
  const Span& span = *domain.span;
  const auto at = [&](double low, double high) {
    return span.logarithmic ? low * std::pow(high / low, u) : low + (high - low) * u;
  };
  double value = 0;
  if (span.whole && span.factor == 1) {  // counts: each as likely as the other
    value = std::clamp(std::floor(at(span.low, span.high + 1)), span.low, span.high);
  } else {
    value = std::clamp(to_digits(at(span.low, span.high), 4), span.low, span.high);
    if (span.whole) value = std::round(value * span.factor) / span.factor;
  }
  return platform::number_text(value) + span.unit;
}

}  // namespace leviosim::tools
