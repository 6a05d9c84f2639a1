// Features followed from frame to frame with the kernels of the profile `next`: corners, two-way
// matches with the last frame, and patches that must agree. No pose is used.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "traces/datasets/image_source.h"

namespace leviosim::tools {

struct FeatureSeen {
  std::size_t frame = 0;
  Eigen::Vector2d pixel{0, 0};
  double corner = 0;           ///< Harris response, as the detector ranks features
  double roundness = 0;        ///< smaller over larger eigenvalue of its structure tensor, 0 ... 1
  Eigen::Vector2d edge{0, 0};  ///< unit vector along the local edge
};

/// Of successive frames.
using Track = std::vector<FeatureSeen>;

struct FrameFeatures {
  std::size_t features = 0;
  std::size_t matches = 0;  ///< with the last frame
  /// Of its features: that another one resembles as much as a match may, more than 8 px away.
  std::size_t alike = 0;
};

struct FeatureTracks {
  std::vector<FrameFeatures> frames;
  std::vector<Track> tracks;  ///< of one feature or more
};

/// Takes frames one after the other.
class FeatureTracker {
 public:
  explicit FeatureTracker(traces::ImageSize size);
  ~FeatureTracker();
  void add(const traces::GrayImage& image);
  FeatureTracks take() { return std::move(result_); }

 private:
  struct View;
  View extract(const traces::GrayImage& image) const;
  static std::size_t alike(View& view);
  /// @return how many matches there are
  std::size_t continue_tracks(View& now) const;

  traces::ImageSize size_;
  std::unique_ptr<View> last_;
  FeatureTracks result_;
};

}  // namespace leviosim::tools
