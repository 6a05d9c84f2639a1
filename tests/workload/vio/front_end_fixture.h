// A front end that tests feed by hand: pictures of rectangles, an IMU at rest, landmarks
// put into its graph.
#pragma once

#include <gtest/gtest.h>

#include "sim/work/machine.h"
#include "tests/workload/inertial/preintegration_motion.h"
#include "tests/workload/test_camera.h"
#include "tests/workload/vision/runs.h"
#include "workload/levio/levio_front_end.h"
#include "workload/vio/profile.h"

namespace leviosim::vio::test {

/// A front end of its own, one frame after the other, its graph open to view.
struct FrontEndAlone {
  using Native = work::Native;

  static constexpr int kWidth = 160, kHeight = 120;
  /// Specific force; the camera's y axis points down.
  inline static const Vector3d kAtRest{0, -9.81, 0};

  explicit FrontEndAlone(const char* profile_name = "levio")
      : profile(profile_named(profile_name, 1)),
        cluster({8, "L1", Bytes(1 << 20), 1, false}),
        memory("L2", Bytes(2'000'000)),
        graph(memory, GraphCapacity{}),
        front_end(profile, {kCamera, kWidth, kHeight, {1, 0, 0, 0, 1, 0, 0, 0, 1}}, cluster, memory,
                  graph) {}

  FrameReport frame(const cv::Mat& image, const Vector3d& accel = kAtRest,
                    const Vector3d& gyro = Vector3d::Zero(), float dt = 0.05f) {
    FrameInput input{image.data, kWidth, kHeight, frames++ > 0 ? dt : 0.0f, {}};
    ImuInput sample{};
    sample.dt = 0.005f;
    for (int i = 0; i < 3; ++i) {
      sample.accel[i] = static_cast<float>(accel[i]);
      sample.gyro[i] = static_cast<float>(gyro[i]);
    }
    input.imu.assign(10, sample);
    return front_end.process(input);
  }

  KeyframeState<Native> newest() const { return graph.keyframe(graph.newest_keyframe()); }

  /// Landmarks that look like the features of `image`: where they appear from the world's origin,
  /// or, if scrambled, somewhere else.
  int add_landmarks(const cv::Mat& image, bool scrambled) {
    const vision_test::Features features =
        vision_test::extract_as_levio<Native>(image, 8, profile.extractor);
    const std::size_t n = features.size();
    graph.age_landmarks();
    for (std::size_t i = 0; i < n; ++i) {
      const auto& seen = features[scrambled ? (i * 7919 + 13) % n : i];
      const float depth = 2.0f + 0.01f * static_cast<float>(i % 97);
      const Vec3<Native> point{(static_cast<float>(seen.x) - kCamera.cx) / kCamera.fx * depth,
                               (static_cast<float>(seen.y) - kCamera.cy) / kCamera.fy * depth,
                               depth};
      graph.add_landmark(point, features[i].words);
    }
    return static_cast<int>(n);
  }

  Profile profile;
  work::Machine cluster;
  work::Arena memory;
  PoseGraph<Native> graph;
  LevioFrontEnd<Native> front_end;
  const cv::Mat flat{kHeight, kWidth, CV_8U, cv::Scalar(100)};
  const cv::Mat picture = vision_test::rectangle_image(kWidth, kHeight, 3);
  int frames = 0;
};

/// What a camera sees after a turn to the right by atan(12 px / fx) = 6°, to first order.
inline cv::Mat turned_right(const cv::Mat& image) {
  cv::Mat turned(image.size(), CV_8U, cv::Scalar(128));
  const int rest = image.cols - 12;
  image(cv::Rect(12, 0, rest, image.rows)).copyTo(turned(cv::Rect(0, 0, rest, image.rows)));
  return turned;
}

}  // namespace leviosim::vio::test
