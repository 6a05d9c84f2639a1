#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/app/report/plot/plot.h"
#include "tools/app/study/systems/systems_report.h"

namespace leviosim::tools {
namespace {

using plot::Anchor;
using plot::Axes;
using plot::Point;
using plot::Range;
using plot::Scale;
using plot::Svg;

constexpr double kWidth = 900;
constexpr double kHeight = 640;
constexpr plot::Box kBox{80, 76, 780, 500};
constexpr const char* kInk = "#1c2733";
constexpr const char* kPublished = "#203e8c";
constexpr const char* kPredicted = "#be202e";
constexpr const char* kEnergy = "#8a939c";

/// A point of the picture, a frame rate and a power in mW.
struct Spot {
  double rate;
  double power_mw;
};

std::optional<Spot> published_spot(const SystemRow& row) {
  const PublishedSystem& p = row.published;
  if (!p.frames_per_s || !p.power_mw) return std::nullopt;
  return Spot{*p.frames_per_s, *p.power_mw};
}

std::optional<Spot> predicted_spot(const SystemRow& row) {
  if (!row.here || !row.here->power) return std::nullopt;
  return Spot{row.here->frames_per_s, row.here->power->value.count() * kMilli};
}

Axes axes_of(const std::vector<SystemRow>& rows) {
  std::optional<Range> rates;
  std::optional<Range> powers;
  const auto include = [&](const std::optional<Spot>& spot) {
    if (!spot) return;
    if (!rates) rates = Range{spot->rate, spot->rate};
    if (!powers) powers = Range{spot->power_mw, spot->power_mw};
    rates->include(spot->rate);
    powers->include(spot->power_mw);
  };
  for (const SystemRow& row : rows) {
    include(published_spot(row));
    include(predicted_spot(row));
  }
  return {kBox, plot::widened_logarithmically(rates.value_or(Range{1, 100}), 0.22),
          plot::widened_logarithmically(powers.value_or(Range{1, 1000}), 0.08), Scale::logarithmic,
          Scale::logarithmic};
}

/// Lines of 1, 10, 100 … µJ per frame: power is energy times rate, a diagonal.
void draw_equal_energies(Svg& svg, const Axes& axes) {
  const int least = static_cast<int>(std::ceil(std::log10(axes.y().low / axes.x().high)));
  const int most = static_cast<int>(std::floor(std::log10(axes.y().high / axes.x().low)));
  svg.begin_clip(axes.box());
  for (int exponent = least; exponent <= most; ++exponent) {
    const double mj = std::pow(10.0, exponent);
    svg.line(axes.at(axes.x().low, mj * axes.x().low), axes.at(axes.x().high, mj * axes.x().high),
             {kEnergy, 1, "5 4"});
    // Below the line's end, at the top of the box or at its right edge.
    const Point end = axes.at(std::min(axes.x().high, axes.y().high / mj),
                              std::min(axes.y().high, axes.x().high * mj));
    svg.text({end.x - 6, end.y + 25}, fmt::format("{:g} mJ", mj), {11, Anchor::end, kEnergy});
  }
  svg.end_group();
}

/// Beside a spot, on the side that has room.
void draw_name(Svg& svg, const Axes& axes, Point at, double below, const std::string& name,
               const char* colour) {
  constexpr double kAside = 10;
  const bool right = at.x < axes.box().x + 0.75 * axes.box().width;
  svg.text({at.x + (right ? kAside : -kAside), at.y + below}, name,
           {12, right ? Anchor::start : Anchor::end, colour});
}

void draw_published(Svg& svg, const Axes& axes, const SystemRow& row) {
  const std::optional<Spot> spot = published_spot(row);
  if (!spot) return;
  constexpr double kArrow = 22;
  const Point at = axes.at(spot->rate, spot->power_mw);
  if (row.published.is_bound) {
    svg.line(at, {at.x, at.y + kArrow}, {kPublished, 1.4});
    svg.polygon({{at.x - 4, at.y + kArrow}, {at.x + 4, at.y + kArrow}, {at.x, at.y + kArrow + 7}},
                kPublished, {kPublished, 0});
  }
  svg.circle(at, 4.5, kPublished, {kPublished, 0});
  draw_name(svg, axes, at, 4, row.published.name, kInk);
}

void draw_predicted(Svg& svg, const Axes& axes, const SystemRow& row) {
  const std::optional<Spot> spot = predicted_spot(row);
  if (!spot) return;
  const Point at = axes.at(spot->rate, spot->power_mw);
  const auto& power = *row.here->power;
  const double low = std::max(power.low().count() * kMilli, axes.y().low);
  svg.line(axes.at(spot->rate, low), axes.at(spot->rate, power.high().count() * kMilli),
           {kPredicted, 1.4});
  svg.circle(at, 5.5, "none", {kPredicted, 2});
  draw_name(svg, axes, at, 16, row.published.name + ", here", kPredicted);
}

}  // namespace

std::string systems_plot(const std::vector<SystemRow>& rows) {
  Svg svg(kWidth, kHeight, "Power over frame rate of systems that estimate motion");
  svg.text({kBox.x, 30}, "Power over frame rate of systems that estimate motion",
           {17, Anchor::start, kInk, true});
  svg.text({kBox.x, 54},
           "dots: published, an arrow below a bound; rings: predicted here, with bands; dashed "
           "lines: equal energy per frame",
           {12});
  const Axes axes = axes_of(rows);
  axes.draw(svg, "frames per second", "power [mW]");
  draw_equal_energies(svg, axes);
  for (const SystemRow& row : rows) draw_published(svg, axes, row);
  for (const SystemRow& row : rows) draw_predicted(svg, axes, row);
  return svg.str();
}

}  // namespace leviosim::tools
