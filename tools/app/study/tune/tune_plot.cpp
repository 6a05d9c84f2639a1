#include "tools/app/study/tune/tuning.h"

#include <fmt/format.h>

#include <array>
#include <functional>

#include "tools/app/report/plot/plot.h"
#include "tools/app/report/text_table.h"

namespace leviosim::tools {
namespace {

using plot::Anchor;
using plot::Axes;
using plot::Box;
using plot::Range;
using plot::Scale;
using plot::Stroke;
using plot::Svg;

constexpr double kWidth = 900;
constexpr double kHeight = 940;
constexpr double kLeftEdge = 80;
constexpr double kPanelWidth = 660;
constexpr double kPanelHeight = 230;
constexpr double kFirstPanel = 92;
constexpr double kPanelStep = 282;
constexpr double kLegendX = 762;
constexpr double kLineHeight = 20;
constexpr double kApart = 8;  ///< frame rates, where they are points [px]
constexpr const char* kInk = "#1c2733";
constexpr const char* kLimit = "#8a939c";
constexpr std::array kColours{"#203e8c", "#2a7f62", "#d98e04", "#be202e", "#7a3b9a", "#5c6670"};

/// One of the figures over the clock. Each seed is a draw, whose value says little about that of
/// the next clock: such figures are points. Power depends on the draws hardly, and is a line in its
/// band.
struct Panel {
  const char* label;
  Scale scale;
  std::function<std::optional<double>(const TunePoint&)> of;  ///< median
  std::optional<double> limit;
  /// Of one seed; none where the figure is a line.
  std::function<std::optional<double>(const RunOutcome&)> of_seed{};
  std::function<std::optional<Banded>(const TunePoint&)> band{};
  bool marks_missing = false;  ///< what has no value is marked at the top
};

std::vector<Panel> panels_of(const TunePlan& plan) {
  const auto above_0 = [](const std::optional<double>& ate) {
    return ate && *ate > 0 ? ate : std::nullopt;
  };
  const auto error = [=](const TunePoint& p) { return above_0(p.ate().median); };
  const auto error_of_seed = [=](const RunOutcome& o) { return above_0(error_of(o)); };
  const auto missed = [](const TunePoint& p) { return std::optional(100 * p.miss_rate()); };
  const auto missed_of_seed = [](const RunOutcome& o) {
    return std::optional(100 * o.loop->camera.share_of(o.loop->camera.missed()));
  };
  const auto band = [](const TunePoint& p) -> std::optional<Banded> {
    const std::optional<Banded> watts = p.median(&LoopOutcome::power_w);
    if (!watts) return std::nullopt;
    return Banded{watts->value * 1e3, watts->low * 1e3, watts->high * 1e3};
  };
  const auto power = [=](const TunePoint& p) {
    const std::optional<Banded> milliwatts = band(p);
    return milliwatts ? std::optional(milliwatts->value) : std::nullopt;
  };
  return {{"absolute trajectory error [m]",
           Scale::logarithmic,
           error,
           plan.ate_m,
           error_of_seed,
           {},
           true},
          {"missed frames [%]", Scale::linear, missed, 100 * plan.miss_rate, missed_of_seed},
          {"mean power [mW]", Scale::linear, power, std::nullopt, {}, band}};
}

std::string colour_of(std::size_t rate) { return kColours[rate % kColours.size()]; }

Range range_of(const Panel& panel, const std::vector<TunePoint>& points) {
  std::optional<Range> range;
  const auto include = [&](const std::optional<double>& value) {
    if (!value || (panel.scale == Scale::logarithmic && !(*value > 0))) return;
    if (!range) range = Range{*value, *value};
    range->include(*value);
  };
  for (const TunePoint& point : points) {
    include(panel.of(point));
    if (panel.of_seed)
      for (const RunOutcome& outcome : point.outcomes) include(panel.of_seed(outcome));
    if (const auto band = panel.band ? panel.band(point) : std::nullopt) {
      include(band->low);
      include(band->high);
    }
  }
  include(panel.limit);
  if (panel.scale == Scale::logarithmic)
    return plot::widened_logarithmically(range.value_or(Range{0.1, 1}), 0.06);
  if (!range) range = Range{0, 1};
  range->include(0);
  return plot::widened(*range, 0.05);
}

/// Where an estimate diverged: a cross at the top.
void draw_cross(Svg& svg, plot::Point at, const Stroke& stroke) {
  constexpr double kHalf = 3.5;
  svg.line({at.x - kHalf, at.y - kHalf}, {at.x + kHalf, at.y + kHalf}, stroke);
  svg.line({at.x - kHalf, at.y + kHalf}, {at.x + kHalf, at.y - kHalf}, stroke);
}

/// The points of a frame rate: every seed, the median, and from the least to the greatest value.
/// @param shift    that keeps frame rates apart [px]
/// @param cross_y  where medians without a value are marked, below the top of the box
void draw_points(Svg& svg, const Axes& axes, const Panel& panel,
                 const std::vector<const TunePoint*>& points, const std::string& colour,
                 double shift, double cross_y) {
  for (const TunePoint* point : points) {
    const auto at = [&](double value) {
      const plot::Point exact = axes.at(megahertz(point->setting.clock), value);
      return plot::Point{exact.x + shift, exact.y};
    };
    std::optional<Range> all;
    for (const RunOutcome& outcome : point->outcomes) {
      const std::optional<double> value = panel.of_seed(outcome);
      if (!value) continue;
      if (!all) all = Range{*value, *value};
      all->include(*value);
      svg.circle(at(*value), 1.5, colour, {colour, 0});
    }
    if (all) svg.line(at(all->low), at(all->high), {colour, 0.8});
    if (const std::optional<double> median = panel.of(*point))
      svg.circle(at(*median), 3.2, colour, {colour, 0});
    else if (panel.marks_missing)
      draw_cross(svg, {at(axes.y().high).x, axes.box().y + cross_y}, {colour, 1.6});
  }
}

/// The line of a frame rate in its band, interrupted where there is no value.
void draw_line(Svg& svg, const Axes& axes, const Panel& panel,
               const std::vector<const TunePoint*>& points, const std::string& colour) {
  constexpr double kBandOpacity = 0.15;
  std::vector<plot::Point> line;
  std::vector<plot::Point> outline;  // of the band: its upper side, and before that its lower one
  const auto finish = [&] {
    if (line.size() > 1) {
      svg.polygon(outline, colour, {colour, 0}, kBandOpacity);
      svg.polyline(line, {colour, 1.6});
    }
    for (const plot::Point& at : line) svg.circle(at, 2.2, colour, {colour, 0});
    line.clear();
    outline.clear();
  };
  for (const TunePoint* point : points) {
    const std::optional<Banded> band = panel.band(*point);
    if (!band) {
      finish();
      continue;
    }
    line.push_back(axes.at(megahertz(point->setting.clock), band->value));
    outline.push_back(axes.at(megahertz(point->setting.clock), band->high));
    outline.insert(outline.begin(), axes.at(megahertz(point->setting.clock), band->low));
  }
  finish();
}

void draw_panel(Svg& svg, const TunePlan& plan, const Panel& panel, const Axes& axes,
                const std::vector<TunePoint>& points, const std::vector<Choice>& choices) {
  axes.draw(svg, "clock [MHz]", panel.label);
  if (panel.limit)
    svg.line(axes.at(axes.x().low, *panel.limit), axes.at(axes.x().high, *panel.limit),
             {kLimit, 1.2, "6 4"});
  for (std::size_t rate = 0; rate < plan.fps.size(); ++rate) {
    std::vector<const TunePoint*> of_rate;
    for (const TunePoint& point : points)
      if (point.fps == plan.fps[rate]) of_rate.push_back(&point);
    const auto i = static_cast<double>(rate);
    const double shift =
        panel.of_seed ? kApart * (i - 0.5 * static_cast<double>(plan.fps.size() - 1)) : 0;
    if (panel.of_seed)
      draw_points(svg, axes, panel, of_rate, colour_of(rate), shift, 8 + 9 * i);
    else
      draw_line(svg, axes, panel, of_rate, colour_of(rate));
    const TunePoint* lowest = choices[rate].lowest;
    const std::optional<double> value = lowest != nullptr ? panel.of(*lowest) : std::nullopt;
    if (!value) continue;
    const plot::Point at = axes.at(megahertz(lowest->setting.clock), *value);
    svg.circle({at.x + shift, at.y}, 6.5, "none", {colour_of(rate), 2});
  }
}

void draw_legend(Svg& svg, const TunePlan& plan) {
  double y = kFirstPanel + 8;
  svg.text({kLegendX, y}, "frames/s", {12, Anchor::start, kInk, true});
  for (std::size_t rate = 0; rate < plan.fps.size(); ++rate) {
    y += kLineHeight;
    svg.line({kLegendX, y - 4}, {kLegendX + 18, y - 4}, {colour_of(rate), 2});
    svg.text({kLegendX + 26, y}, fmt::format("{:g}", plan.fps[rate]), {});
  }
  y += 1.5 * kLineHeight;
  svg.circle({kLegendX + 9, y - 4}, 3.2, kInk, {kInk, 0});
  svg.text({kLegendX + 26, y}, plan.variations.size() > 1 ? "median" : "the seed", {});
  if (plan.variations.size() > 1) {
    y += kLineHeight;
    svg.circle({kLegendX + 9, y - 4}, 1.5, kInk, {kInk, 0});
    svg.text({kLegendX + 26, y}, plan.perturbs ? "each run" : "each seed", {});
  }
  y += kLineHeight;
  svg.polygon(
      {{kLegendX, y - 9}, {kLegendX + 18, y - 9}, {kLegendX + 18, y + 1}, {kLegendX, y + 1}}, kInk,
      {kInk, 0}, 0.15);
  svg.text({kLegendX + 26, y}, "band of power", {});
  y += 1.5 * kLineHeight;
  svg.line({kLegendX, y - 4}, {kLegendX + 18, y - 4}, {kLimit, 1.2, "6 4"});
  svg.text({kLegendX + 26, y}, "limit", {});
  y += kLineHeight;
  svg.circle({kLegendX + 9, y - 4}, 6.5, "none", {kInk, 2});
  svg.text({kLegendX + 26, y}, "lowest that meets the limits", {});
  y += kLineHeight;
  draw_cross(svg, {kLegendX + 9, y - 4}, {kInk, 1.6});
  svg.text({kLegendX + 26, y}, "diverged", {});
}

}  // namespace

std::string tune_plot(const TunePlan& plan, const std::vector<TunePoint>& points,
                      const std::vector<Choice>& choices) {
  Svg svg(kWidth, kHeight, "Error, missed frames and power over the clock");
  svg.text({kLeftEdge, 34},
           fmt::format("Error, missed frames and power of {} over the clock", plan.request.profile),
           {17, Anchor::start, kInk, true});
  svg.text({kLeftEdge, 56},
           fmt::format("{}, {} cores, at the lowest voltage of each clock; {}, {} frames recorded "
                       "at {:g} frames/s;",
                       plan.request.platform.name, plan.request.cores,
                       folder_name(plan.sequence.folder), plan.sequence.frames, plan.recorded_hz),
           {12});
  const std::string medians = plan.variations.size() > 1
                                  ? fmt::format("; medians over {} {}", plan.variations.size(),
                                                plan.perturbs ? "runs" : "seeds")
                                  : "";
  svg.text({kLeftEdge, 74}, std::string(info_of(plan.deadline).description) + medians, {12});
  Range x{megahertz(points.front().setting.clock), megahertz(points.front().setting.clock)};
  for (const TunePoint& point : points) x.include(megahertz(point.setting.clock));
  double top = kFirstPanel;
  for (const Panel& panel : panels_of(plan)) {
    const Axes axes({kLeftEdge, top, kPanelWidth, kPanelHeight}, plot::widened(x, 0.02),
                    range_of(panel, points), Scale::linear, panel.scale);
    draw_panel(svg, plan, panel, axes, points, choices);
    top += kPanelStep;
  }
  draw_legend(svg, plan);
  return svg.str();
}

}  // namespace leviosim::tools
