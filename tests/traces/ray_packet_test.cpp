// What a packet of rays meets is what each ray meets alone, and boxes project into their bounds.
#include "traces/synthesis/ray_packet.h"
#include "traces/synthesis/screen_bounds.h"

#include <gtest/gtest.h>

#include "traces/datasets/rng.h"

namespace leviosim::traces {
namespace {

using Eigen::Vector3f;

Vector3f random_vector(Rng& rng, double range) {
  const auto draw = [&] { return static_cast<float>(rng.uniform(-range, range)); };
  const float x = draw(), y = draw(), z = draw();
  return {x, y, z};
}

World cluttered(Rng& rng) {
  std::vector<Box> boxes;
  for (int i = 0; i < 30; ++i) {
    const Vector3f centre = random_vector(rng, 3);
    const Vector3f half = random_vector(rng, 0.5).cwiseAbs().array() + 0.01f;
    boxes.push_back(plain_box(centre - half, centre + half, 100));
  }
  return World(plain_box({-4, -4, -4}, {4, 4, 4}, 10), std::move(boxes));
}

TEST(RayPacket, EachRayMeetsWhatItMeetsAlone) {
  Rng rng(1);
  const World world = cluttered(rng);
  std::vector<int> all;
  for (int i = 0; i < 30; ++i) all.push_back(i);
  RayPacket packet;
  int objects_met = 0;
  for (int round = 0; round < 50; ++round) {
    const Vector3f origin = random_vector(rng, 1);
    const Eigen::Matrix3f rotation =
        Eigen::AngleAxisf(static_cast<float>(round), random_vector(rng, 1).normalized())
            .toRotationMatrix();
    std::vector<Vector3f> rays;
    for (int i = 0; i < 1 + round * 5; ++i) rays.push_back(random_vector(rng, 1));
    packet.aim(origin, rotation, rays);
    packet.cast(world, all);
    ASSERT_EQ(packet.size(), static_cast<int>(rays.size()));
    for (int i = 0; i < packet.size(); ++i) {
      const Vector3f direction = rotation * rays[static_cast<std::size_t>(i)];
      const Hit alone = world.cast(origin, direction);
      const Hit hit = packet.hit(world, i);
      ASSERT_EQ(packet.direction(i), direction);
      ASSERT_EQ(hit.box, alone.box);
      ASSERT_EQ(hit.face, alone.face);
      ASSERT_EQ(hit.reach, alone.reach);
      objects_met += hit.box != &world.room();
    }
  }
  EXPECT_GT(objects_met, 500);
}

TEST(ScreenBounds, HoldEveryVisiblePointOfTheBox) {
  Rng rng(2);
  int points_in_front = 0;
  for (int round = 0; round < 300; ++round) {
    const Vector3f centre = random_vector(rng, 2);
    const Vector3f half = random_vector(rng, 1.5).cwiseAbs();
    const Box box = plain_box(centre - half, centre + half, 0);
    const Eigen::Isometry3f pose(
        Eigen::AngleAxisf(0.1f * static_cast<float>(round), random_vector(rng, 1).normalized()));
    ScreenBounds bounds = screen_bounds(box, pose);
    bounds =
        ScreenBounds(bounds.min().array() * 1.001f - 1e-3f, bounds.max().array() * 1.001f + 1e-3f);
    for (int i = 0; i < 50; ++i) {
      const Vector3f point = pose * (centre + random_vector(rng, 1).cwiseProduct(half));
      if (point.z() < 2e-3f) continue;
      ++points_in_front;
      const Eigen::Vector2f seen = point.head<2>() / point.z();
      const Eigen::Vector2f slack = 2e-3f * seen.cwiseAbs();
      EXPECT_TRUE(((seen + slack).array() >= bounds.min().array()).all() &&
                  ((seen - slack).array() <= bounds.max().array()).all())
          << round;
    }
  }
  EXPECT_GT(points_in_front, 3000);
}

TEST(ScreenBounds, AreTightAndEmptyBehind) {
  const Box ahead = plain_box({-1, -2, 4}, {1, 2, 8}, 0);
  const ScreenBounds bounds = screen_bounds(ahead, Eigen::Isometry3f::Identity());
  EXPECT_TRUE(bounds.min().isApprox(Eigen::Vector2f(-0.25f, -0.5f)));
  EXPECT_TRUE(bounds.max().isApprox(Eigen::Vector2f(0.25f, 0.5f)));
  const Box behind = plain_box({-1, -2, -8}, {1, 2, -4}, 0);
  EXPECT_TRUE(screen_bounds(behind, Eigen::Isometry3f::Identity()).isEmpty());
}

}  // namespace
}  // namespace leviosim::traces
