#include <gtest/gtest.h>

#include <vector>

#include "tests/workload/inertial/preintegration_motion.h"
#include "workload/inertial/initialisation.h"

namespace leviosim::vio::test {
namespace {

using work::Counting;
using work::Native;

constexpr int kSamplesPerFrame = 10;

/// A detector with memory of its own.
template <class P>
struct Detector {
  using F = typename P::F32;
  explicit Detector(const StillnessOptions& options = {})
      : memory(static_cast<std::size_t>(StillnessDetector<P>::floats(options))),
        detector(options, {memory.data(), static_cast<int>(memory.size())}) {}
  std::vector<F> memory;
  StillnessDetector<P> detector;
};

struct Readings {
  Vector3d gyro, accel;
  double gyro_noise, accel_noise;  ///< standard deviation of the whole vector
};

/// Feeds frames of samples; returns the verdict in each frame.
template <class P>
std::vector<Stillness<P>> feed(StillnessDetector<P>& detector, const Readings& r, int frames,
                               TestRandom& random) {
  std::vector<Stillness<P>> verdicts;
  for (int f = 0; f < frames; ++f) {
    for (int i = 0; i < kSamplesPerFrame; ++i)
      detector.add({0.005f, to_vec3<P>(r.gyro + random.normal3() * (r.gyro_noise / std::sqrt(3.0))),
                    to_vec3<P>(r.accel + random.normal3() * (r.accel_noise / std::sqrt(3.0)))});
    verdicts.push_back(detector.evaluate());
    detector.end_frame();
  }
  return verdicts;
}

const Readings kStill{{0.0, 0.02, 0.08}, {0.3, -9.7, 1.0}, 0.01, 0.1};
const Readings kMoving{{0.0, 0.02, 0.08}, {0.3, -9.7, 1.0}, 0.07, 0.4};

TEST(Stillness, IsSeenOnceASecondIsFull) {
  Detector<Native> d;
  TestRandom random(1);
  const auto verdicts = feed<Native>(d.detector, kStill, 25, random);
  for (int f = 0; f < 25; ++f)
    EXPECT_EQ(verdicts[static_cast<std::size_t>(f)].still, f >= 19) << "frame " << f;
  EXPECT_LT((to_eigen<Native>(verdicts.back().gyro_mean) - kStill.gyro).norm(), 0.003);
  EXPECT_LT((to_eigen<Native>(verdicts.back().accel_mean) - kStill.accel).norm(), 0.03);
}

TEST(Stillness, IsNotSeenInAMovingVehicle) {
  Detector<Native> d;
  TestRandom random(2);
  for (const auto& verdict : feed<Native>(d.detector, kMoving, 30, random))
    EXPECT_FALSE(verdict.still);
}

TEST(Stillness, EitherSensorTellsMotion) {
  for (const Readings& r : {Readings{kStill.gyro, kStill.accel, 0.08, 0.1},
                            Readings{kStill.gyro, kStill.accel, 0.01, 0.9}}) {
    Detector<Native> d;
    TestRandom random(3);
    EXPECT_FALSE(feed<Native>(d.detector, r, 30, random).back().still);
  }
}

TEST(Stillness, ForgetsMotionAfterASecond) {
  Detector<Native> d;
  TestRandom random(4);
  feed<Native>(d.detector, {{0.5, 0.0, 0.0}, {3.0, -9.0, 0.0}, 0.3, 2.0}, 33, random);
  const auto verdicts = feed<Native>(d.detector, kStill, 20, random);
  for (int f = 0; f < 20; ++f)
    EXPECT_EQ(verdicts[static_cast<std::size_t>(f)].still, f == 19) << "frame " << f;
}

TEST(Stillness, LeavesOutMotionThatHasJustBegun) {
  Detector<Native> d;
  TestRandom random(6);
  feed<Native>(d.detector, kStill, 25, random);
  // Slow enough to pass for rest yet: a turn of 0.1 rad/s for a tenth of the last second.
  const Vector3d begun = kStill.gyro + Vector3d(0.1, 0.0, 0.0);
  Stillness<Native> seen{}, earlier{};
  for (int f = 0; f < 2; ++f) {
    for (int i = 0; i < kSamplesPerFrame; ++i)
      d.detector.add({0.005f, to_vec3<Native>(begun), to_vec3<Native>(kStill.accel)});
    seen = d.detector.evaluate();
    earlier = d.detector.without_recent(seen);
    d.detector.end_frame();
  }
  ASSERT_TRUE(seen.still);
  EXPECT_TRUE(earlier.still);
  EXPECT_GT((to_eigen<Native>(seen.gyro_mean) - kStill.gyro).norm(), 0.008);
  EXPECT_LT((to_eigen<Native>(earlier.gyro_mean) - kStill.gyro).norm(), 0.003);
  EXPECT_LT((to_eigen<Native>(earlier.accel_mean) - kStill.accel).norm(), 0.03);
}

TEST(Stillness, CountsWhatItComputesNatively) {
  Detector<Native> native;
  Detector<Counting> counting;
  TestRandom random(5), same(5);
  const auto a = feed<Native>(native.detector, kStill, 25, random).back();
  const auto b = feed<Counting>(counting.detector, kStill, 25, same).back();
  EXPECT_EQ(a.still, b.still);
  EXPECT_EQ(a.gyro_mean.z, b.gyro_mean.z.v);
  EXPECT_EQ(a.accel_mean.y, b.accel_mean.y.v);
}

TEST(Gravity, PointsAgainstTheSpecificForceInTheWorld) {
  const Motion motion;
  const double t = 0.7;
  const Vector3d at_rest = Motion::rotation(t).transpose() * -motion.gravity * (9.7 / 9.81);
  const Vec3<Native> g =
      gravity_from_force<Native>(to_vec3<Native>(at_rest), to_mat3<Native>(Motion::rotation(t)));
  EXPECT_LT((to_eigen<Native>(g) - motion.gravity).norm(), 1e-5);
}

TEST(Gravity, MeanForceOfABatch) {
  std::vector<float> batch(4 * kImuSampleFloats, 0.0f);
  for (std::size_t i = 0; i < 4; ++i) {
    batch[i * kImuSampleFloats] = 0.005f;
    batch[i * kImuSampleFloats + 4] = static_cast<float>(i);
    batch[i * kImuSampleFloats + 6] = -9.0f;
  }
  const work::NativeSpan<float> span(batch.data(), static_cast<int>(batch.size()));
  const Vec3<Native> mean = mean_force<Native>(span, 4);
  EXPECT_EQ(mean.x, 1.5f);
  EXPECT_EQ(mean.y, 0.0f);
  EXPECT_EQ(mean.z, -9.0f);
  EXPECT_EQ(mean_force<Native>(span, 2).x, 0.5f);
}

}  // namespace
}  // namespace leviosim::vio::test
