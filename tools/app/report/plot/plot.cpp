#include "tools/app/report/plot/plot.h"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>

namespace leviosim::tools::plot {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";

/// Two decimals, no negative zero.
std::string px(double value) {
  constexpr double kPrintsAsZero = 0.005;
  return fmt::format("{:.2f}", std::abs(value) < kPrintsAsZero ? 0.0 : value);
}

std::string stroke_attributes(const Stroke& stroke) {
  std::string text =
      fmt::format("stroke=\"{}\" stroke-width=\"{}\"", stroke.colour, px(stroke.width));
  if (!stroke.dashes.empty()) text += fmt::format(" stroke-dasharray=\"{}\"", stroke.dashes);
  return text;
}

std::string box_attributes(const Box& box) {
  return fmt::format("x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"", px(box.x), px(box.y),
                     px(box.width), px(box.height));
}

std::string_view markup(char c) {
  switch (c) {
    case '&':
      return "&amp;";
    case '<':
      return "&lt;";
    case '>':
      return "&gt;";
    case '"':
      return "&quot;";
    case '\'':
      return "&apos;";
    default:
      return {};
  }
}

/// Bytes of the character that `text` begins with; 0 if XML does not allow it or it is no UTF-8.
std::size_t character_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  if (byte(0) < 0x80u) return byte(0) >= 0x20u || text[0] == '\t' || text[0] == '\n' ? 1 : 0;
  constexpr std::array<std::uint32_t, 5> kLeast{0, 0, 0x80, 0x800, 0x10000};
  const std::size_t length = byte(0) >= 0xF0u ? 4 : byte(0) >= 0xE0u ? 3 : 2;
  if (byte(0) >= 0xF8u || byte(0) < 0xC0u || text.size() < length) return 0;
  std::uint32_t code = byte(0) & (0xFFu >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0u) != 0x80u) return 0;
    code = code << 6 | (byte(i) & 0x3Fu);
  }
  const bool forbidden = code < kLeast[length] || code > 0x10FFFF ||
                         (code >= 0xD800 && code <= 0xDFFF) || code == 0xFFFE || code == 0xFFFF;
  return forbidden ? 0 : length;
}

double distance(Point a, Point b) { return std::hypot(a.x - b.x, a.y - b.y); }

std::string path_points(const std::vector<Point>& points) {
  constexpr double kLeastStep = 0.25;
  std::string text;
  Point last;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool end = i == 0 || i + 1 == points.size();
    if (!end && distance(points[i], last) < kLeastStep) continue;
    last = points[i];
    text += fmt::format("{}{},{}", i == 0 ? "" : " ", px(last.x), px(last.y));
  }
  return text;
}

}  // namespace

std::string escape_xml(std::string_view text) {
  std::string escaped;
  while (!text.empty()) {
    const std::size_t length = character_length(text);
    const std::string_view special = markup(text.front());
    if (length == 0)
      escaped += kReplacement;
    else
      escaped += special.empty() ? text.substr(0, length) : special;
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return escaped;
}

Svg::Svg(double width, double height, std::string_view title) : width_(width), height_(height) {
  body_ = fmt::format("<title>{}</title>\n", escape_xml(title));
  rectangle({0, 0, width, height}, "#ffffff");
}

void Svg::line(Point from, Point to, const Stroke& stroke) {
  fmt::format_to(std::back_inserter(body_), "<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\" {}/>\n",
                 px(from.x), px(from.y), px(to.x), px(to.y), stroke_attributes(stroke));
}

void Svg::polyline(const std::vector<Point>& points, const Stroke& stroke) {
  if (points.empty()) return;
  fmt::format_to(std::back_inserter(body_),
                 "<polyline fill=\"none\" stroke-linejoin=\"round\" stroke-linecap=\"round\" {} "
                 "points=\"{}\"/>\n",
                 stroke_attributes(stroke), path_points(points));
}

void Svg::rectangle(const Box& box, std::string_view fill) {
  fmt::format_to(std::back_inserter(body_), "<rect {} fill=\"{}\"/>\n", box_attributes(box), fill);
}

void Svg::rectangles(const std::vector<Box>& boxes, std::string_view fill) {
  if (boxes.empty()) return;
  fmt::format_to(std::back_inserter(body_), "<path fill=\"{}\" d=\"", fill);
  for (const Box& box : boxes)
    fmt::format_to(std::back_inserter(body_), "M{:g} {:g}h{:g}v{:g}h{:g}z", box.x, box.y, box.width,
                   box.height, -box.width);
  body_ += "\"/>\n";
}

void Svg::frame(const Box& box, const Stroke& stroke) {
  fmt::format_to(std::back_inserter(body_), "<rect {} fill=\"none\" {}/>\n", box_attributes(box),
                 stroke_attributes(stroke));
}

void Svg::circle(Point centre, double radius, std::string_view fill, const Stroke& stroke) {
  fmt::format_to(std::back_inserter(body_),
                 "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{}\" {}/>\n", px(centre.x),
                 px(centre.y), px(radius), fill, stroke_attributes(stroke));
}

void Svg::polygon(const std::vector<Point>& corners, std::string_view fill, const Stroke& stroke,
                  double opacity) {
  std::string points;
  for (const Point& p : corners)
    points += fmt::format("{}{},{}", points.empty() ? "" : " ", px(p.x), px(p.y));
  const std::string see_through =
      opacity < 1 ? fmt::format(" fill-opacity=\"{:g}\"", opacity) : std::string();
  fmt::format_to(std::back_inserter(body_), "<polygon points=\"{}\" fill=\"{}\"{} {}/>\n", points,
                 fill, see_through, stroke_attributes(stroke));
}

void Svg::text(Point at, std::string_view text, const TextStyle& style) {
  constexpr std::array<std::string_view, 3> kAnchors{"start", "middle", "end"};
  const std::string turn =
      style.upwards ? fmt::format(" transform=\"rotate(-90 {} {})\"", px(at.x), px(at.y)) : "";
  fmt::format_to(std::back_inserter(body_),
                 "<text x=\"{}\" y=\"{}\" font-size=\"{}\" text-anchor=\"{}\" fill=\"{}\"{}{}>{}"
                 "</text>\n",
                 px(at.x), px(at.y), px(style.size),
                 kAnchors[static_cast<std::size_t>(style.anchor)], style.colour,
                 style.bold ? " font-weight=\"bold\"" : "", turn, escape_xml(text));
}

void Svg::begin_clip(const Box& box) {
  const int id = ++clips_;
  fmt::format_to(std::back_inserter(body_),
                 "<clipPath id=\"clip{}\"><rect {}/></clipPath>\n<g clip-path=\"url(#clip{})\">\n",
                 id, box_attributes(box), id);
}

void Svg::end_group() { body_ += "</g>\n"; }

std::string Svg::str() const {
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" "
      "viewBox=\"0 0 {0} {1}\" font-family=\"Helvetica, Arial, sans-serif\">\n{2}</svg>\n",
      px(width_), px(height_), body_);
}

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

namespace {

using Rgb = std::array<double, 3>;
constexpr std::array<Rgb, 4> kStops{{{32, 62, 140}, {29, 145, 140}, {232, 156, 40}, {190, 32, 46}}};

}  // namespace

int colour_index(double value, double max) {
  if (!(max > 0)) return 0;
  return std::min(static_cast<int>(std::clamp(value / max, 0.0, 1.0) * kColours), kColours - 1);
}

std::string colour(int index) {
  const double place = static_cast<double>(index) / (kColours - 1) * (kStops.size() - 1);
  const std::size_t stop = std::min(static_cast<std::size_t>(place), kStops.size() - 2);
  const double s = place - static_cast<double>(stop);
  const auto mix = [&](std::size_t i) {
    return static_cast<int>(std::lround((1 - s) * kStops[stop][i] + s * kStops[stop + 1][i]));
  };
  return fmt::format("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2));
}

}  // namespace leviosim::tools::plot
