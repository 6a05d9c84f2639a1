// A frame that finds no landmark where they should be: how much it tries to find its place. And a
// map that its alignment has moved.
#include <gtest/gtest.h>

#include "sim/work/machine.h"
#include "tests/workload/test_camera.h"
#include "tests/workload/vision/runs.h"
#include "workload/next/guided_tracking.h"
#include "workload/next/plausibility.h"
#include "workload/next/prediction.h"
#include "workload/vio/inertial_part.h"
#include "workload/vio/map_start.h"
#include "workload/vio/stages.h"

namespace leviosim::vio::test {
namespace {

using P = work::Counting;

/// Sees one picture twice; the second time it is taken for turned around.
struct LostFrame {
  static constexpr int kWidth = 160, kHeight = 120;

  explicit LostFrame(const Profile& chosen)
      : profile(chosen),
        machine({8, "L1", Bytes(1 << 20), 1, true}),
        memory("L2", Bytes(2'000'000)),
        graph(memory, GraphCapacity{}),
        state(profile, {kCamera, kWidth, kHeight, {1, 0, 0, 0, 1, 0, 0, 0, 1}}, machine, memory,
              graph),
        inertial(state) {
    const work::EitherFrame lists(machine);
    TrackedFrame<P> first;
    see(first);
    start_map<P>(state, first);
    add_landmarks();
  }

  void see(TrackedFrame<P>& frame) {
    FrameInput input{picture.data, kWidth, kHeight, 0.05f, {}};
    ImuInput sample{};
    sample.dt = 0.005f;
    sample.accel[1] = -9.81f;
    input.imu.assign(10, sample);
    take_image(input, state);
    inertial.integrate(input);
    extract_frame<P>(state, frame);
  }

  /// Where the features are seen from the world's origin.
  void add_landmarks() {
    const auto features = vision_test::extract<work::Native>(picture, 8, profile.extractor);
    const auto steps = static_cast<float>(profile.extractor.subpixel_steps);
    graph.age_landmarks();
    for (std::size_t i = 0; i < features.size(); ++i) {
      const float depth = 2.0f + 0.01f * static_cast<float>(i % 97);
      const float x = (static_cast<float>(features[i].x) / steps - kCamera.cx) / kCamera.fx;
      const float y = (static_cast<float>(features[i].y) / steps - kCamera.cy) / kCamera.fy;
      graph.add_landmark({x * depth, y * depth, depth}, features[i].words);
    }
  }

  FrameReport track() {
    const work::EitherFrame lists(machine);
    TrackedFrame<P> frame;
    see(frame);
    machine.take_job();
    Pose<P> behind = Pose<P>::identity();
    behind.R.m[0][0] = behind.R.m[2][2] = -1.0f;
    FrameReport report;
    track_landmarks<P>(state, inertial, random, behind, frame, report);
    return report;
  }

  /// Poses that EPnP has tried: each core of a fork computes one.
  int tried() {
    int forks = 0;
    for (const auto& stage : machine.take_job().stages)
      for (const work::Step& step : stage.steps)
        if (stage.stage == stages::kEpnp && std::holds_alternative<work::Fork>(step)) ++forks;
    return forks * machine.cores();
  }

  Profile profile;
  work::Machine machine;
  work::Arena memory;
  PoseGraph<P> graph;
  FrontEndState<P> state;
  InertialPart<P> inertial;
  levio::ShiftRegister<P> random{1};
  const cv::Mat picture = vision_test::rectangle_image(kWidth, kHeight, 3);
};

TEST(LostFrame, TriesAsManyPosesAsAFrameHasTimeFor) {
  LostFrame lost(profile_named("next", 1));
  EXPECT_EQ(lost.track().source, PoseSource::Tracked);
  EXPECT_EQ(lost.tried(), lost.profile.recovery.hypotheses);
  EXPECT_LT(lost.profile.recovery.hypotheses, lost.profile.epnp.iterations);
}

/// It moves the map by metres, which at any other time would be a map that is given up.
TEST(AlignedMap, IsNotJudgedByWhereTheCameraWasReportedBefore) {
  LostFrame scene(profile_named("next", 1));
  MapStatus map;
  Prediction<P> prediction(scene.state, scene.inertial, map, scene.memory);
  prediction.remember({}, {});
  const auto is_plausible = [&] { return map_is_plausible(scene.state, prediction, true); };
  EXPECT_TRUE(is_plausible());
  const auto slot = scene.graph.newest_keyframe();
  KeyframeState<P> aligned = scene.graph.keyframe(slot);
  aligned.T_world_camera.t.x = 5.0f;
  scene.graph.set_keyframe(slot, aligned);
  EXPECT_FALSE(is_plausible());
  map.aligned = true;
  prediction.follow_alignment();
  EXPECT_TRUE(is_plausible());
}

}  // namespace
}  // namespace leviosim::vio::test
