#include "tools/app/evaluation/evaluation.h"

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <sstream>
#include <vector>

#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "tools/app/report/plot/plot.h"
#include "tools/app/report/text_table.h"
#include "traces/trajectories/evaluation.h"
#include "traces/trajectories/trajectory_errors.h"

namespace leviosim::tools {
namespace {

/// @returns whether the text ended in it
bool remove_suffix(std::string& text, std::string_view suffix) {
  if (!text.ends_with(suffix)) return false;
  text.resize(text.size() - suffix.size());
  return true;
}

std::vector<double> parse_lengths(const std::vector<std::string>& words) {
  std::vector<double> lengths;
  for (const std::string& word : words) {
    std::istringstream list(word + ',');  // "1,2" is two of them, and "1," one and a fault
    for (std::string length; std::getline(list, length, ',');)
      lengths.push_back(parse_positive("--relative", length));
  }
  if (lengths.empty()) lengths.push_back(kDefaultLength);
  std::sort(lengths.begin(), lengths.end());
  lengths.erase(std::unique(lengths.begin(), lengths.end()), lengths.end());
  return lengths;
}

outputs::OutputRequest output(const EvalOptions& options, const char* option,
                              const std::string& file) {
  outputs::OutputRequest request{.option = option,
                                 .path = file,
                                 .replace = options.force,
                                 .inputs = {options.estimate, options.truth, options.times}};
  request.inputs.insert(request.inputs.end(), options.also.begin(), options.also.end());
  return request;
}

/// Told from each other as files, not as names.
void claim_outputs(const EvalOptions& options, EvalRequest& request) {
  if (!options.plot.empty() && std::filesystem::path(options.plot).extension() != ".svg")
    throw InputError(fmt::format("--plot {}: expected a file that ends in .svg", options.plot));
  if (!options.plot.empty() && !options.also.empty())
    throw InputError(
        fmt::format("--plot {}: draws one estimate; expected no --also", options.plot));
  request.json = claimed_file(output(options, "--json", options.json));
  request.plot = claimed_file(output(options, "--plot", options.plot));
  expect_different(request.plot, "--plot", request.json, "--json");
}

}  // namespace

void add_eval_options(CLI::App& command, EvalOptions& options) {
  command.add_option("EST", options.estimate, "estimated trajectory: a file or a run folder");
  command.add_option("GT", options.truth, "ground truth: a file or an ASL folder");
  const TextOptions add{command};
  add("--also", options.also, "EST",
      "another estimate of the same flight, repeatable: a row for each, side by side");
  add("--align", options.align, "KIND",
      "what is aligned first: se3, sim3, posyaw (gravity is known, z up) or none [se3]");
  add("--max-dt", options.max_dt, "TIME",
      "to the nearest true sample of a matched pose: 10ms, 0.01s, or a number of ms [10ms]");
  add("--relative", options.relative, "M",
      "lengths of sub-trajectories in metres: 10,40; repeatable [40]");
  add("--expected", options.expected, "N",
      "completion is of N poses, e.g. the frames fed in [of the ground truth's duration]");
  add("--format", options.format, "FORMAT", "of both files: tum, euroc or kitti [as they look]");
  add("--times", options.times, "FILE", "time stamps of KITTI files, seconds, one a line");
  command
      .add_option("--json", options.json,
                  "write the figures to a file; without one, at the end, print them as JSON")
      ->type_name("FILE")
      ->expected(0, 1);
  add("--plot", options.plot, "FILE.svg", "draw views from top and side, and errors over time");
  command.add_flag("--force", options.force, "replace these files");
}

EvalRequest make_eval_request(const CLI::App& command, const EvalOptions& options) {
  require(command, "EST", "an estimated trajectory: a TUM, EuRoC or KITTI file, or a run folder");
  require(command, "GT", "the ground truth: a TUM, EuRoC or KITTI file, or an ASL folder");
  EvalRequest request;
  request.evaluation.alignment = traces::parse_alignment(options.align);
  request.evaluation.max_gap_ns = parse_tolerance("--max-dt", options.max_dt);
  if (command.count("--expected") > 0)
    request.evaluation.expected_poses = static_cast<std::size_t>(
        parse_whole("--expected", options.expected, 1, std::numeric_limits<std::int32_t>::max()));
  request.lengths_m = parse_lengths(options.relative);
  if (command.count("--format") > 0)
    request.read.format = traces::parse_trajectory_format(options.format);
  request.read.times = options.times;
  claim_outputs(options, request);
  return request;
}

std::int64_t parse_tolerance(const std::string& option, const std::string& text) {
  constexpr double kMostNs = 3600e9;
  std::string number = text;
  double ns_per_unit = 1e6;
  if (!remove_suffix(number, "ms") && remove_suffix(number, "s")) ns_per_unit = 1e9;
  double value = 0;
  if (!base::parse_number(number, value) || value < 0 || value * ns_per_unit > kMostNs)
    throw InputError(fmt::format("{} '{}': expected a time such as 10ms or 0.01s, at most an hour",
                                 option, text));
  return std::llround(value * ns_per_unit);
}

namespace {

using plot::Anchor;
using plot::Axes;
using plot::Box;
using plot::Point;
using plot::Range;
using plot::Svg;
using traces::Evaluation;
using traces::MatchedPose;

constexpr double kWidth = 1000;
constexpr double kHeight = 900;
constexpr double kLegendY = 100;
constexpr Box kTopView{70, 134, 400, 360};
constexpr Box kSideView{570, 134, 400, 360};
constexpr Box kTranslation{70, 560, 900, 130};
constexpr Box kTilt{70, 742, 400, 110};
constexpr Box kHeading{570, 742, 400, 110};
constexpr const char* kTruthColour = "#b4bbc4";
constexpr const char* kInk = "#1c2733";
constexpr const char* kErrorColour = "#203e8c";
constexpr double kTruthWidth = 3;
constexpr double kEstimateWidth = 1.6;

/// What the picture is drawn from.
struct Picture {
  const Evaluation& evaluation;
  traces::Trajectory truth;  ///< from the first to the last matched pose
  bool timed;
  std::vector<double> translation;  ///< errors [m], one per matched pose
  traces::AttitudeErrors attitude;
  std::int64_t longest_step_ns;  ///< a longer one is a gap, over which nothing is drawn
};

/// Ten times the usual step between poses.
std::int64_t longest_step(const std::vector<MatchedPose>& poses) {
  std::vector<std::int64_t> steps;
  for (std::size_t i = 1; i < poses.size(); ++i) steps.push_back(poses[i].t_ns - poses[i - 1].t_ns);
  if (steps.empty()) return 0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return 10 * *middle;
}

Picture picture_of(const traces::TrajectoryPair& pair, const Evaluation& evaluation) {
  Picture picture{evaluation,
                  {},
                  pair.estimate.stamps == traces::Stamps::time,
                  {},
                  attitude_errors(evaluation).value_or(traces::AttitudeErrors{}),
                  longest_step(evaluation.poses)};
  const std::int64_t first = evaluation.poses.front().t_ns;
  const std::int64_t last = evaluation.poses.back().t_ns;
  for (const traces::StampedPose& pose : pair.truth.poses)
    if (pose.t_ns >= first && pose.t_ns <= last) picture.truth.push_back(pose);
  for (const MatchedPose& pose : evaluation.poses)
    picture.translation.push_back(traces::translation_error(pose));
  for (double& heading : picture.attitude.headings_deg) heading = std::abs(heading);
  return picture;
}

/// Calls `draw(first, last)` for each run of poses without a gap whose steps have one kind.
void for_each_segment(const Picture& picture, const std::function<int(std::size_t)>& kind_of_step,
                      const std::function<void(std::size_t, std::size_t)>& draw) {
  const std::vector<MatchedPose>& poses = picture.evaluation.poses;
  const auto gap = [&](std::size_t i) {
    return poses[i].t_ns - poses[i - 1].t_ns > picture.longest_step_ns;
  };
  std::size_t first = 0;
  for (std::size_t i = 1; i <= poses.size(); ++i) {
    const bool ends =
        i == poses.size() || gap(i) || (i - 1 > first && kind_of_step(i) != kind_of_step(i - 1));
    if (!ends) continue;
    draw(first, i - 1);
    first = i == poses.size() || gap(i) ? i : i - 1;
  }
}

Range range_of(const Picture& picture, int axis) {
  const double start = picture.evaluation.poses.front().truth.translation()[axis];
  Range range{start, start};
  for (const MatchedPose& pose : picture.evaluation.poses)
    range.include(pose.estimate.translation()[axis]);
  for (const traces::StampedPose& pose : picture.truth)
    range.include(pose.T_world_body.translation()[axis]);
  return plot::widened(range, 0.06);
}

void draw_start_and_end(Svg& svg, Point start, Point end) {
  svg.circle(start, 5, "#ffffff", {kInk, 2});
  svg.rectangle({end.x - 4.5, end.y - 4.5, 9, 9}, kInk);
}

/// The truth and the estimate in the plane of the axes x and `vertical` (1: y, 2: z).
void draw_paths(Svg& svg, const Axes& axes, const Picture& picture, int vertical) {
  const auto at = [&](const Eigen::Isometry3d& pose) {
    return axes.at(pose.translation().x(), pose.translation()[vertical]);
  };
  svg.begin_clip(axes.box());
  std::vector<Point> truth;
  for (const traces::StampedPose& pose : picture.truth) truth.push_back(at(pose.T_world_body));
  svg.polyline(truth, {kTruthColour, kTruthWidth});
  const std::vector<MatchedPose>& poses = picture.evaluation.poses;
  const double worst = picture.evaluation.translation.max;
  const auto colour_of_step = [&](std::size_t i) {
    return plot::colour_index(std::max(picture.translation[i - 1], picture.translation[i]), worst);
  };
  for_each_segment(picture, colour_of_step, [&](std::size_t first, std::size_t last) {
    std::vector<Point> points;
    for (std::size_t i = first; i <= last; ++i) points.push_back(at(poses[i].estimate));
    const std::string colour = plot::colour(colour_of_step(std::max<std::size_t>(last, 1)));
    svg.polyline(points, {colour, kEstimateWidth});
  });
  draw_start_and_end(svg, at(poses.front().truth), at(poses.back().truth));
  svg.end_group();
}

/// Both views at one scale.
void draw_views(Svg& svg, const Picture& picture) {
  const Range x = range_of(picture, 0);
  const Range y = range_of(picture, 1);
  const Range z = range_of(picture, 2);
  const double height = std::max(y.length(), z.length());
  const auto view = [&](const Box& box, const Range& vertical, int axis, const char* title) {
    const double middle = 0.5 * (vertical.low + vertical.high);
    const auto [across, up] =
        plot::equal_aspect(box, x, {middle - height / 2, middle + height / 2});
    const Axes axes(box, across, up);
    axes.draw(svg, "x [m]", axis == 1 ? "y [m]" : "z [m]");
    svg.text({box.x, box.y - 8}, title, {13, Anchor::start, kInk, true});
    draw_paths(svg, axes, picture, axis);
  };
  view(kTopView, y, 1, "view from top");
  view(kSideView, z, 2, "view from the side");
}

/// One error over time, with a dashed line at its root mean square.
void draw_errors(Svg& svg, const Box& box, const Picture& picture,
                 const std::vector<double>& errors, double rmse, const std::string& unit) {
  const std::vector<MatchedPose>& poses = picture.evaluation.poses;
  const double unit_ns = picture.timed ? 1e9 : 1;
  const std::int64_t start = picture.timed ? poses.front().t_ns : 0;
  const auto time = [&](std::size_t i) {
    return static_cast<double>(poses[i].t_ns - start) / unit_ns;
  };
  const double worst = *std::max_element(errors.begin(), errors.end());
  const Axes axes(box, plot::widened({time(0), time(poses.size() - 1)}, 0),
                  {0, std::max(worst * 1.12, 1e-6)});
  const bool lowest = box.y == kTilt.y;
  const char* label = picture.timed ? "time since the first matched pose [s]" : "pose number";
  axes.draw(svg, lowest ? label : "", unit);
  svg.begin_clip(box);
  const double y = axes.at(0, rmse).y;
  svg.line({box.x, y}, {box.right(), y}, {"#be202e", 1.2, "6 4"});
  for_each_segment(
      picture, [](std::size_t) { return 0; },
      [&](std::size_t first, std::size_t last) {
        std::vector<Point> points;
        for (std::size_t i = first; i <= last; ++i) points.push_back(axes.at(time(i), errors[i]));
        svg.polyline(points, {kErrorColour, 1.4});
      });
  svg.end_group();
}

void draw_error_panels(Svg& svg, const Picture& picture) {
  const Evaluation& e = picture.evaluation;
  const auto panel = [&](const Box& box, const char* name, const std::vector<double>& errors,
                         double rmse, const char* unit) {
    svg.text({box.x, box.y - 8}, fmt::format("{} error", name), {13, Anchor::start, kInk, true});
    svg.text({box.right(), box.y - 8}, fmt::format("dashed: RMSE {:.3g} {}", rmse, unit),
             {12, Anchor::end});
    draw_errors(svg, box, picture, errors, rmse, fmt::format("[{}]", unit));
  };
  panel(kTranslation, "translation", picture.translation, e.translation.rmse, "m");
  const traces::AttitudeErrors& a = picture.attitude;
  panel(kTilt, "tilt", a.tilts_deg, a.tilt_rmse_deg, "deg");
  panel(kHeading, "heading", a.headings_deg, a.heading_rmse_deg, "deg");
}

void draw_legend(Svg& svg, const Picture& picture) {
  constexpr double kCell = 5;
  constexpr double kScaleX = 426;
  constexpr double kTextY = kLegendY + 4;
  svg.line({70, kLegendY}, {98, kLegendY}, {kTruthColour, kTruthWidth});
  svg.text({106, kTextY}, "ground truth", {});
  svg.text({206, kTextY}, "estimate, by translation error:", {});
  svg.text({kScaleX - 6, kTextY}, "0", {12, Anchor::end});
  for (int i = 0; i < plot::kColours; ++i)
    svg.rectangle(
        {kScaleX + kCell * i, kLegendY - 5, kCell + (i + 1 < plot::kColours ? 0.5 : 0), 10},
        plot::colour(i));
  svg.text({kScaleX + kCell * plot::kColours + 6, kTextY},
           fmt::format("{:.3g} m", picture.evaluation.translation.max), {});
  svg.circle({650, kLegendY}, 5, "#ffffff", {kInk, 2});
  svg.text({662, kTextY}, "start", {});
  svg.rectangle({716, kLegendY - 4.5, 9, 9}, kInk);
  svg.text({732, kTextY}, "end of the matched part", {});
}

/// The protocol, in lines that fit the picture.
void draw_heading(Svg& svg, const Picture& picture) {
  constexpr int kCharacters = 125;
  const Evaluation& e = picture.evaluation;
  svg.text({70, 34},
           fmt::format("Absolute trajectory error {:.3f} m RMSE ({:.3f} m at worst), tilt {:.2f}°, "
                       "heading {:.2f}° RMSE",
                       e.translation.rmse, e.translation.max, picture.attitude.tilt_rmse_deg,
                       picture.attitude.heading_rmse_deg),
           {17, Anchor::start, kInk, true});
  std::vector<std::string> words;
  std::istringstream protocol(e.protocol);
  for (std::string word; protocol >> word;) words.push_back(word);
  std::istringstream lines(wrap(words, " ", 0, kCharacters));
  double y = 56;
  for (std::string line; std::getline(lines, line); y += 16) svg.text({70, y}, line, {12});
}

}  // namespace

std::string trajectory_plot(const traces::TrajectoryPair& pair, const Evaluation& evaluation) {
  const Picture picture = picture_of(pair, evaluation);
  Svg svg(
      kWidth, kHeight,
      fmt::format("{} compared with {}", pair.estimate.file.string(), pair.truth.file.string()));
  draw_heading(svg, picture);
  draw_legend(svg, picture);
  draw_views(svg, picture);
  draw_error_panels(svg, picture);
  return svg.str();
}

}  // namespace leviosim::tools
