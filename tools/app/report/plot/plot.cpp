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

std::string Svg::str() const {
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" "
      "viewBox=\"0 0 {0} {1}\" font-family=\"Helvetica, Arial, sans-serif\">\n{2}</svg>\n",
      px(width_), px(height_), body_);
}

namespace {

/// Whole multiples of `step` in the range, as factors.
std::pair<double, double> multiples(const Range& range, double step) {
  constexpr double kRounding = 1e-9;  // a limit that is a multiple itself counts
  return {std::ceil(range.low / step - kRounding), std::floor(range.high / step + kRounding)};
}

}  // namespace

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

}  // namespace leviosim::tools::plot
