#include "tools/app/validation/distributions.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "sim/base/csv.h"
#include "sim/base/nearest_name.h"
#include "tools/app/validation/published_files.h"
#include "workload/vio/stages.h"

namespace leviosim::tools {
namespace {

using Samples = std::vector<double>;
using Frame = LoggedFrame;

/// Of the frames after the first one that are asked for.
template <class Wanted, class Value>
Samples of_frames(const FrameLog& log, const Wanted& wanted, const Value& value) {
  Samples samples;
  for (const Frame& frame : log.frames())
    if (frame.result.source != PoseSource::First && wanted(frame))
      samples.push_back(static_cast<double>(value(frame)));
  return samples;
}

bool is_any(const Frame&) { return true; }
bool ran_epnp(const Frame& frame) { return frame.find(vio::stages::kEpnp) != nullptr; }
bool ran_eight_point(const Frame& frame) { return frame.find(vio::stages::kEightPoint) != nullptr; }
bool from_epnp(const Frame& frame) { return frame.result.source == PoseSource::Epnp; }
bool from_eight_point(const Frame& frame) { return frame.result.source == PoseSource::EightPoint; }
bool is_keyframe(const Frame& frame) { return frame.result.keyframe; }

int features(const Frame& frame) { return frame.result.features; }
int world_matches(const Frame& frame) { return frame.result.world_matches; }
int frame_matches(const Frame& frame) { return frame.result.frame_matches; }
int inliers(const Frame& frame) { return frame.result.inliers; }
int landmarks(const Frame& frame) { return frame.landmarks_before; }

/// 100 where it is so, and else 0: their mean is a share in per cent.
template <class Wanted>
Samples share_of_frames(const FrameLog& log, const Wanted& wanted) {
  return of_frames(log, is_any, [&](const Frame& frame) { return wanted(frame) ? 100 : 0; });
}

struct Input {
  std::string_view quantity;
  Samples (*samples)(const FrameLog&);
  bool is_share = false;
};
using Log = FrameLog;
const std::array kInputs{
    Input{"keypoints of a frame", [](const Log& l) { return of_frames(l, is_any, features); }},
    Input{"landmarks compared in world matching",
          [](const Log& l) { return of_frames(l, is_any, landmarks); }},
    Input{"two-way world matches of a frame",
          [](const Log& l) { return of_frames(l, is_any, world_matches); }},
    Input{"two-way frame matches of a frame",
          [](const Log& l) { return of_frames(l, is_any, frame_matches); }},
    Input{"frames with EPnP", [](const Log& l) { return share_of_frames(l, ran_epnp); }, true},
    Input{"frames with 8-point", [](const Log& l) { return share_of_frames(l, ran_eight_point); },
          true},
    Input{"keyframes", [](const Log& l) { return share_of_frames(l, is_keyframe); }, true},
    Input{"EPnP: matches scored",
          [](const Log& l) { return of_frames(l, ran_epnp, world_matches); }},
    Input{"EPnP: inliers of the best",
          [](const Log& l) { return of_frames(l, from_epnp, inliers); }},
    Input{"8-point: matches scored",
          [](const Log& l) { return of_frames(l, ran_eight_point, frame_matches); }},
    Input{"8-point: inliers of the best",
          [](const Log& l) { return of_frames(l, from_eight_point, inliers); }},
    Input{"EPnP: rotations of a hypothesis",
          [](const Log& l) { return l.ransac().epnp_rotations; }},
    Input{"8-point: rotations of a hypothesis",
          [](const Log& l) { return l.ransac().eight_point_rotations; }},
    Input{"8-point: steps of 9x9 of a hypothesis",
          [](const Log& l) { return l.ransac().eight_point_steps; }},
    Input{"8-point: steps of the slowest of eight",
          [](const Log& l) { return l.ransac().slowest_of_eight; }},
};

const Input& input_named(const base::CsvRow& row) {
  std::vector<std::string> names;
  for (const Input& input : kInputs) {
    if (row.text(0) == input.quantity) return input;
    names.emplace_back(input.quantity);
  }
  row.fail(0, "unknown" + base::did_you_mean(row.text(0), names));
}

InputDistribution::Cells simulated(const Input& input, const FrameLog& log) {
  InputDistribution::Cells cells;
  const std::optional<Distribution> found = distribution_of(input.samples(log));
  if (!found) return cells;
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (i == 0 || !input.is_share) cells[i] = (*found)[i];
  return cells;
}

}  // namespace

std::optional<Distribution> distribution_of(std::vector<double> samples) {
  if (samples.empty()) return std::nullopt;
  std::sort(samples.begin(), samples.end());
  const auto quantile = [&](double share) {
    const double place = share * static_cast<double>(samples.size() - 1);
    const auto below = static_cast<std::size_t>(place);
    const std::size_t above = std::min(below + 1, samples.size() - 1);
    return std::lerp(samples[below], samples[above], place - static_cast<double>(below));
  };
  double sum = 0;
  for (const double sample : samples) sum += sample;
  return Distribution{sum / static_cast<double>(samples.size()), quantile(0.1), quantile(0.5),
                      quantile(0.9), samples.back()};
}

std::vector<InputDistribution> input_distributions(const std::string& file, std::string_view text,
                                                   const FrameLog& log) {
  std::vector<std::string> columns{"quantity"};
  for (const std::string_view column : {"mean", "p10", "median", "p90", "max"})
    columns.emplace_back(column);
  std::vector<InputDistribution> rows;
  for_each_row(file, text, columns, [&](const base::CsvRow& row) {
    const Input& input = input_named(row);
    InputDistribution& distribution = rows.emplace_back(
        InputDistribution{std::string(input.quantity), {}, simulated(input, log)});
    for (std::size_t i = 0; i < kDistributionColumns.size(); ++i)
      if (!row.text(i + 1).empty()) distribution.released[i] = row.number(i + 1);
  });
  return rows;
}

std::vector<InputDistribution> input_distributions(const FrameLog& log) {
  constexpr std::string_view kName = "released_inputs";
  return input_distributions(fmt::format("{}.csv", kName), reference_text(kName), log);
}

}  // namespace leviosim::tools
