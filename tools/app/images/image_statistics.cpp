#include "tools/app/images/image_statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "sim/base/csv.h"
#include "sim/base/interruption.h"
#include "tools/app/images/feature_tracks.h"
#include "tools/app/images/picture_figures.h"
#include "tools/app/images/track_geometry.h"
#include "tools/app/table/terminal_table.h"
#include "traces/trajectories/association.h"

namespace leviosim::tools {
namespace {

struct Quantity {
  const char* name;
  const char* unit;
  const char* over;
};

enum Which {
  kFeatures,
  kMatches,
  kAlike,
  kLife,
  kError,
  kAlong,
  kAcross,
  kOutliers,
  kDepth,
  kDepthSpread,
  kCorner,
  kRoundness,
  kBrightness,
  kContrast,
  kLocal,
  kDark,
  kGlare,
  kNoise,
  kEdgeWidth,
  kQuantities
};

constexpr std::array<Quantity, kQuantities> kRows{{
    {"features", "number", "frames"},
    {"matches with the last frame", "number", "frames"},
    {"features like another one", "%", "frames"},
    {"length of the track", "frames", "observations"},
    {"error against true poses", "px", "observations"},
    {"... along the edge", "px", "observations"},
    {"... across the edge", "px", "observations"},
    {"outliers", "%", "frames"},
    {"depth", "m", "observations"},
    {"depth, far over near", "ratio", "frames"},
    {"corner strength", "ratio", "features"},
    {"roundness of corners", "ratio", "features"},
    {"brightness", "grey", "frames"},
    {"contrast", "grey", "frames"},
    {"contrast in 8x8 px", "grey", "squares"},
    {"dark pixels", "%", "frames"},
    {"glaring pixels", "%", "frames"},
    {"noise", "grey", "frames"},
    {"width of edges", "px", "frames"},
}};

using Samples = std::array<std::vector<double>, kQuantities>;

double percent(std::size_t part, std::size_t whole) {
  return 100 * static_cast<double>(part) / static_cast<double>(std::max<std::size_t>(whole, 1));
}

void add_picture(PictureFigures figures, Samples& to) {
  to[kBrightness].push_back(figures.brightness);
  to[kContrast].push_back(figures.contrast);
  to[kDark].push_back(100 * figures.dark);
  to[kGlare].push_back(100 * figures.glare);
  if (figures.noise) to[kNoise].push_back(*figures.noise);
  if (figures.edge_width) to[kEdgeWidth].push_back(*figures.edge_width);
  to[kLocal].insert(to[kLocal].end(), figures.local.begin(), figures.local.end());
}

void add_features(const FeatureTracks& features, Samples& to) {
  for (const FrameFeatures& frame : features.frames) {
    to[kFeatures].push_back(static_cast<double>(frame.features));
    if (&frame != &features.frames.front())
      to[kMatches].push_back(static_cast<double>(frame.matches));
    to[kAlike].push_back(percent(frame.alike, frame.features));
  }
  for (const Track& track : features.tracks)
    for (const FeatureSeen& seen : track) {
      to[kLife].push_back(static_cast<double>(track.size()));
      to[kCorner].push_back(seen.corner);
      to[kRoundness].push_back(seen.roundness);
    }
}

/// What the true poses say of a frame.
struct FrameGeometry {
  std::size_t observations = 0;
  std::size_t outliers = 0;
  std::vector<double> depths;
};

class Geometry {
 public:
  Geometry(const traces::Dataset& data, const traces::PinholeIntrinsics& camera, Samples& to)
      : camera_(camera), to_(to) {
    traces::Trajectory stamps;
    for (const traces::FrameRef& frame : data.frames)
      stamps.push_back({frame.t_ns, Eigen::Isometry3d::Identity()});
    constexpr std::int64_t kMostGapNs = 20'000'000;
    std::map<std::int64_t, Eigen::Isometry3d> truth;
    for (const traces::MatchedPose& pose :
         associate(stamps, traces::to_trajectory(data.ground_truth), kMostGapNs))
      truth.emplace(pose.t_ns, pose.truth * data.camera.T_body_camera);
    for (const traces::FrameRef& frame : data.frames) {
      const auto found = truth.find(frame.t_ns);
      known_.push_back(found != truth.end());
      poses_.push_back(known_.back() ? found->second : Eigen::Isometry3d::Identity());
    }
    frames_.resize(data.frames.size());
  }

  void add(Track track) {
    std::erase_if(track, [this](const FeatureSeen& seen) { return !known_[seen.frame]; });
    const std::optional<TrackGeometry> geometry = track_geometry(track, poses_, camera_);
    if (!geometry) return;
    for (std::size_t i = 0; i < track.size(); ++i) {
      const Eigen::Vector2d& error = geometry->errors[i];
      const double along = error.dot(track[i].edge);
      to_[kError].push_back(error.norm());
      to_[kAlong].push_back(std::abs(along));
      to_[kAcross].push_back((error - along * track[i].edge).norm());
      FrameGeometry& frame = frames_[track[i].frame];
      frame.observations += 1;
      frame.outliers += error.norm() > kOutlierPx ? 1 : 0;
      if (!geometry->depths.empty()) frame.depths.push_back(geometry->depths[i]);
    }
  }

  void end() {
    constexpr std::size_t kEnough = 10;
    for (FrameGeometry& frame : frames_) {
      if (frame.observations >= kEnough)
        to_[kOutliers].push_back(percent(frame.outliers, frame.observations));
      to_[kDepth].insert(to_[kDepth].end(), frame.depths.begin(), frame.depths.end());
      if (frame.depths.size() >= kEnough)
        to_[kDepthSpread].push_back(quantile(frame.depths, 0.9) / quantile(frame.depths, 0.1));
    }
  }

 private:
  traces::PinholeIntrinsics camera_;
  Samples& to_;
  std::vector<Eigen::Isometry3d> poses_;  // of the camera, by frame
  std::vector<bool> known_;
  std::vector<FrameGeometry> frames_;
};

std::string number(const ImageStatistic& row, double value) {
  return row.count == 0 ? "–" : fmt::format("{:.3g}", value);
}

/// Of medians; nothing where one of them is 0 or does not exist.
std::optional<double> ratio(const ImageStatistic& first, const ImageStatistic& last) {
  if (first.count == 0 || last.count == 0 || first.median == 0 || last.median == 0)
    return std::nullopt;
  return last.median / first.median;
}

}  // namespace

ImageStatistics image_statistics(const std::string& name, const traces::Dataset& data,
                                 traces::ImageSize size,
                                 const std::function<void(std::size_t)>& progress) {
  const traces::ImageSource source(data, size);
  Samples samples;
  FeatureTracker tracker(size);
  for (std::size_t i = 0; i < source.size(); ++i) {
    throw_if_interrupted();
    const traces::GrayImage image = source.read(i);
    add_picture(picture_figures(image), samples);
    tracker.add(image);
    if (progress) progress(i + 1);
  }
  const FeatureTracks features = tracker.take();
  add_features(features, samples);
  Geometry geometry(data, source.intrinsics(), samples);
  for (const Track& track : features.tracks) geometry.add(track);
  geometry.end();
  ImageStatistics result{name, source.size(), {}};
  for (std::size_t i = 0; i < kQuantities; ++i) {
    ImageStatistic& row = result.rows.emplace_back();
    row = {kRows[i].name, kRows[i].unit, kRows[i].over, samples[i].size()};
    if (row.count == 0) continue;
    row.tenth = quantile(samples[i], 0.1);
    row.median = quantile(samples[i], 0.5);
    row.ninth_tenth = quantile(samples[i], 0.9);
  }
  return result;
}

std::string image_statistics_table(const std::vector<ImageStatistics>& all) {
  std::vector<Head> columns{{"quantity", kLeft}, {"unit", kLeft, 2}};
  for (const ImageStatistics& one : all) {
    columns.push_back({"10 %", kRight, 1});
    columns.push_back({one.name});
    columns.push_back({"90 %", kRight, 1});
  }
  if (all.size() > 1) columns.push_back({"ratio"});
  Table table(columns);
  for (std::size_t i = 0; i < kQuantities; ++i) {
    std::vector<Cell> cells{kRows[i].name, kRows[i].unit};
    for (const ImageStatistics& one : all)
      for (const double value : {one.rows[i].tenth, one.rows[i].median, one.rows[i].ninth_tenth})
        cells.push_back(number(one.rows[i], value));
    if (all.size() > 1) {
      const std::optional<double> r = ratio(all.front().rows[i], all.back().rows[i]);
      cells.push_back(r ? fmt::format("{:.2f}", *r) : "–");
    }
    table.add(std::move(cells));
  }
  return terminal_text(table);
}

Table image_statistics_rows(const std::vector<ImageStatistics>& all) {
  struct Row {
    const std::string& recording;
    const ImageStatistic& at;
  };
  std::vector<Row> rows;
  for (const ImageStatistics& one : all)
    for (const ImageStatistic& row : one.rows) rows.push_back({one.name, row});
  const auto value = [](double ImageStatistic::*of) {
    return [of](const Row& r) {
      return r.at.count == 0 ? Cell() : spelled(fmt::format("{:.6g}", r.at.*of));
    };
  };
  return table_of(Columns<Row>{{{.key = "recording"}, [](const Row& r) { return r.recording; }},
                               {{.key = "quantity"}, [](const Row& r) { return r.at.name; }},
                               {{.key = "unit"}, [](const Row& r) { return r.at.unit; }},
                               {{.key = "over"}, [](const Row& r) { return r.at.over; }},
                               {{.key = "count"}, [](const Row& r) { return r.at.count; }},
                               {{.key = "tenth"}, value(&ImageStatistic::tenth)},
                               {{.key = "median"}, value(&ImageStatistic::median)},
                               {{.key = "ninth_tenth"}, value(&ImageStatistic::ninth_tenth)}},
                  rows);
}

std::vector<std::string> different_quantities(const ImageStatistics& a, const ImageStatistics& b) {
  constexpr double kFactor = 1.25;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < a.rows.size(); ++i)
    if (const std::optional<double> r = ratio(a.rows[i], b.rows[i]);
        r && (*r > kFactor || *r < 1 / kFactor))
      names.push_back(a.rows[i].name);
  return names;
}

}  // namespace leviosim::tools
