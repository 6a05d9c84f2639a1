#include "tools/app/study/explore/scatter_plot.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tools/app/report/plot/plot.h"

namespace leviosim::tools {
namespace {

using plot::Anchor;
using plot::Axes;
using plot::Box;
using plot::Point;
using plot::Range;
using plot::Stroke;
using plot::Svg;

constexpr double kWidth = 900;
constexpr double kHeight = 680;
constexpr Box kBox{80, 96, 560, 520};
constexpr double kLegendX = 664;
constexpr double kLineHeight = 20;
/// Ten times the distance flown: an estimate that diverged, and would squeeze all others together.
constexpr double kLargestRelative = 1000;
constexpr const char* kInk = "#1c2733";
constexpr std::array kColours{"#be202e", "#203e8c", "#d98e04", "#2a7f62", "#7a3b9a", "#5c6670"};
constexpr std::array kCorners{0, 4, 3, 5, 6, 8};  ///< of the shapes; 0 is a circle

/// What one mark shows.
struct Mark {
  double relative, ate;
  std::size_t profile, sequence;
  bool as_it_is;
};

std::vector<Mark> marks_of(const BatchPlan& plan, const std::vector<ExploredPoint>& explored) {
  std::vector<Mark> marks;
  for (const ExploredPoint& point : explored) {
    const auto profile = static_cast<std::size_t>(
        std::find(plan.profiles.begin(), plan.profiles.end(), point.profile) -
        plan.profiles.begin());
    for (std::size_t s = 0; s < point.sequences.size(); ++s) {
      const std::optional<double>& ate = point.sequences[s].ate.median;
      const std::optional<double>& relative = point.sequences[s].relative.median;
      if (ate && relative && *ate > 0 && *relative > 0 && *relative <= kLargestRelative)
        marks.push_back({*relative, *ate, profile, s, point.point == 0});
    }
  }
  // The profiles as they are come last, on top of the others.
  std::stable_partition(marks.begin(), marks.end(), [](const Mark& m) { return !m.as_it_is; });
  return marks;
}

void draw_shape(Svg& svg, Point at, std::size_t sequence, double radius, const std::string& fill,
                const Stroke& stroke) {
  const int corners = kCorners[sequence % kCorners.size()];
  if (corners == 0) return svg.circle(at, radius, fill, stroke);
  std::vector<Point> points;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners;
    points.push_back(
        {at.x + 1.2 * radius * std::sin(angle), at.y - 1.2 * radius * std::cos(angle)});
  }
  svg.polygon(points, fill, stroke);
}

std::string colour_of(std::size_t profile) { return kColours[profile % kColours.size()]; }

void draw_legend(Svg& svg, const BatchPlan& plan) {
  double y = kBox.y + 6;
  const auto title = [&](const char* text) {
    svg.text({kLegendX, y}, text, {12, Anchor::start, kInk, true});
    y += kLineHeight;
  };
  const auto entry = [&](const std::string& text, std::size_t shape, const std::string& fill,
                         const Stroke& stroke) {
    draw_shape(svg, {kLegendX + 6, y - 4}, shape, 5, fill, stroke);
    svg.text({kLegendX + 20, y}, text, {});
    y += kLineHeight;
  };
  title("profile");
  for (std::size_t i = 0; i < plan.profiles.size(); ++i)
    entry(plan.profiles[i], 0, colour_of(i), {"#ffffff", 0.8});
  y += kLineHeight / 2;
  title("sequence");
  const std::vector<std::string> sequences = sequence_names(plan);
  for (std::size_t i = 0; i < sequences.size(); ++i)
    entry(sequences[i], i, "#8a939c", {"#ffffff", 0.8});
  y += kLineHeight / 2;
  title("outlined");
  entry("the profile as it is", 0, "#ffffff", {kInk, 2});
}

/// Ranges of both axes, never empty.
std::pair<Range, Range> ranges_of(const std::vector<Mark>& marks) {
  if (marks.empty()) return {{1, 10}, {1, 10}};
  Range x{marks.front().relative, marks.front().relative};
  Range y{marks.front().ate, marks.front().ate};
  for (const Mark& mark : marks) {
    x.include(mark.relative);
    y.include(mark.ate);
  }
  return {plot::widened_logarithmically(x, 0.06), plot::widened_logarithmically(y, 0.06)};
}

}  // namespace

std::string scatter_plot(const BatchPlan& plan, const std::vector<ExploredPoint>& explored) {
  const std::vector<Mark> marks = marks_of(plan, explored);
  const std::size_t all = explored.size() * sequence_names(plan).size();
  Svg svg(kWidth, kHeight, "Absolute over relative error of the points explored");
  svg.text({kBox.x, 34}, "Absolute and relative error over the parameters of the workload",
           {17, Anchor::start, kInk, true});
  svg.text({kBox.x, 56}, measure_text(plan.measure) + ";", {12});
  svg.text(
      {kBox.x, 74},
      fmt::format("medians over {} and folders; images {}; {} of {} marks, the others diverged "
                  "(beyond 1000 %)",
                  plan.seeds.size() == 1 ? "1 seed" : fmt::format("{} seeds", plan.seeds.size()),
                  size_text(plan.sizes.front()), marks.size(), all),
      {12});
  const auto [x, y] = ranges_of(marks);
  const Axes axes(kBox, x, y, plot::Scale::logarithmic);
  axes.draw(svg, fmt::format("mean translation error over {:g} m [%]", plan.measure.length_m),
            "absolute translation RMSE [m]");
  for (const Mark& mark : marks)
    draw_shape(svg, axes.at(mark.relative, mark.ate), mark.sequence, mark.as_it_is ? 7 : 4,
               colour_of(mark.profile), mark.as_it_is ? Stroke{kInk, 2} : Stroke{"#ffffff", 0.6});
  draw_legend(svg, plan);
  return svg.str();
}

}  // namespace leviosim::tools
