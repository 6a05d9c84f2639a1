#include "tools/app/report/plot/axes.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace leviosim::tools::plot {
namespace {

constexpr double kPxPerTickX = 70;
constexpr double kPxPerTickY = 34;
constexpr const char* kGridColour = "#e4e7eb";
constexpr const char* kFrameColour = "#9aa3ad";

int most_ticks(double pixels, double pixels_per_tick) {
  return std::max(4, static_cast<int>(pixels / pixels_per_tick) + 1);
}

/// Whole multiples of `step` in the range, as factors.
std::pair<double, double> multiples(const Range& range, double step) {
  constexpr double kRounding = 1e-9;  // a limit that is a multiple itself counts
  return {std::ceil(range.low / step - kRounding), std::floor(range.high / step + kRounding)};
}

}  // namespace

void Range::include(double value) {
  low = std::min(low, value);
  high = std::max(high, value);
}

Range widened(const Range& range, double margin) {
  const double middle = 0.5 * (range.low + range.high);
  const double least = std::max(1e-6, std::abs(middle) * 1e-6);
  const double half = std::max(range.length() * (0.5 + margin), least);
  return {middle - half, middle + half};
}

Ticks round_ticks(const Range& range, int most) {
  constexpr std::array<double, 3> kMantissas{1, 2, 5};
  int exponent = static_cast<int>(std::floor(std::log10(range.length() / most)));
  for (std::size_t i = 0;; ++i) {
    if (i == kMantissas.size()) {
      i = 0;
      ++exponent;
    }
    const double step = kMantissas[i] * std::pow(10.0, exponent);
    const auto [first, last] = multiples(range, step);
    if (last - first + 1 > most) continue;
    Ticks ticks{step, {}};
    for (int k = 0; first + k <= last; ++k) ticks.values.push_back((first + k) * step);
    return ticks;
  }
}

std::string tick_label(double value, double step) {
  constexpr int kMostDecimals = 9;
  const int decimals =
      std::clamp(static_cast<int>(-std::floor(std::log10(step) + 1e-9)), 0, kMostDecimals);
  const std::string text = fmt::format("{:.{}f}", value, decimals);
  return text.find_first_not_of("-0.") == std::string::npos && text.front() == '-' ? text.substr(1)
                                                                                   : text;
}

std::pair<Range, Range> equal_aspect(const Box& box, const Range& x, const Range& y) {
  const double per_px = std::max(x.length() / box.width, y.length() / box.height);
  const auto around = [&](const Range& range, double pixels) -> Range {
    const double middle = 0.5 * (range.low + range.high);
    return {middle - 0.5 * per_px * pixels, middle + 0.5 * per_px * pixels};
  };
  return {around(x, box.width), around(y, box.height)};
}

std::vector<double> logarithmic_ticks(const Range& range, int most) {
  const int first = static_cast<int>(std::floor(std::log10(range.low)));
  const int last = static_cast<int>(std::ceil(std::log10(range.high)));
  std::vector<double> all;
  std::vector<double> powers;
  for (int exponent = first; exponent <= last; ++exponent)
    for (const double mantissa : {1.0, 2.0, 5.0}) {
      const double value = mantissa * std::pow(10.0, exponent);
      if (value < range.low || value > range.high) continue;
      all.push_back(value);
      if (mantissa == 1) powers.push_back(value);
    }
  if (all.size() < 2) return round_ticks(range, most).values;
  return all.size() > static_cast<std::size_t>(most) && powers.size() > 1 ? powers : all;
}

Range widened_logarithmically(const Range& range, double margin) {
  const Range wide = widened({std::log10(range.low), std::log10(range.high)}, margin);
  return {std::pow(10.0, wide.low), std::pow(10.0, wide.high)};
}

Point Axes::at(double x, double y) const {
  const auto share = [](double value, const Range& range, Scale scale) {
    if (scale == Scale::linear) return (value - range.low) / range.length();
    return std::log(value / range.low) / std::log(range.high / range.low);
  };
  return {box_.x + share(x, x_, x_scale_) * box_.width,
          box_.bottom() - share(y, y_, y_scale_) * box_.height};
}

std::vector<Axes::Tick> Axes::ticks(const Range& range, Scale scale, int most) {
  std::vector<Tick> ticks;
  if (scale == Scale::logarithmic) {
    for (const double value : logarithmic_ticks(range, most))
      ticks.push_back({value, fmt::format("{:.6g}", value)});
    return ticks;
  }
  const Ticks round = round_ticks(range, most);
  for (const double value : round.values) ticks.push_back({value, tick_label(value, round.step)});
  return ticks;
}

void Axes::draw_x(Svg& svg) const {
  for (const Tick& tick : ticks(x_, x_scale_, most_ticks(box_.width, kPxPerTickX))) {
    const double x = at(tick.value, y_.low).x;
    svg.line({x, box_.y}, {x, box_.bottom()}, {kGridColour});
    svg.text({x, box_.bottom() + 15}, tick.label, {11, Anchor::middle});
  }
}

void Axes::draw_y(Svg& svg) const {
  for (const Tick& tick : ticks(y_, y_scale_, most_ticks(box_.height, kPxPerTickY))) {
    const double y = at(x_.low, tick.value).y;
    svg.line({box_.x, y}, {box_.right(), y}, {kGridColour});
    svg.text({box_.x - 6, y + 4}, tick.label, {11, Anchor::end});
  }
}

void Axes::draw(Svg& svg, const std::string& x_label, const std::string& y_label) const {
  draw_x(svg);
  draw_y(svg);
  svg.frame(box_, {kFrameColour});
  svg.text({box_.x + box_.width / 2, box_.bottom() + 33}, x_label, {12, Anchor::middle});
  TextStyle upwards{12, Anchor::middle};
  upwards.upwards = true;
  svg.text({box_.x - 42, box_.y + box_.height / 2}, y_label, upwards);
}

}  // namespace leviosim::tools::plot
