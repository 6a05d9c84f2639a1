#include "traces/synthesis/world.h"
#include "traces/synthesis/texture.h"

#include <gtest/gtest.h>

#include "traces/datasets/rng.h"

namespace leviosim::traces {
namespace {

using Eigen::Vector3f;

World two_boxes() {
  return World(
      plain_box({-4, -3, 0}, {4, 3, 4}, 10),
      {plain_box({2, -0.5f, 1}, {2.5f, 0.5f, 2}, 100), plain_box({3, -1, 0}, {3.5f, 1, 3}, 200)});
}

TEST(World, RaysMeetTheNearestFace) {
  const World world = two_boxes();
  const Vector3f eye(0, 0, 1.5f);
  const Hit front = world.cast(eye, {1, 0, 0});
  EXPECT_EQ(front.box, &world.objects()[0]);
  EXPECT_EQ(front.face, 0) << "its -x face";
  EXPECT_FLOAT_EQ(front.reach, 2);
  const Hit behind = world.cast(eye, {1, 0, 0.3f});  // passes over the first box
  EXPECT_EQ(behind.box, &world.objects()[1]);
  EXPECT_FLOAT_EQ(behind.reach, 3);
  const Hit wall = world.cast(eye, {-2, 0, 0});
  EXPECT_EQ(wall.box, &world.room());
  EXPECT_EQ(wall.face, 0);
  EXPECT_FLOAT_EQ(wall.reach, 2);
  EXPECT_EQ(world.cast(eye, {0, 0, 1}).face, 5);
  EXPECT_EQ(world.cast(eye, {0, 0.1f, -1}).face, 4);
  EXPECT_EQ(world.cast(eye, {0, -1, 0.1f}).face, 2);
  const std::vector<int> second{1};
  EXPECT_EQ(world.cast(eye, {1, 0, 0}, second).box, &world.objects()[1]);
}

TEST(World, HitsLieOnSurfacesAndNothingIsBefore) {
  const World world = two_boxes();
  Rng rng(3);
  const auto inside = [](const Box& box, const Vector3f& p, float margin) {
    return ((p - box.min).array() > margin).all() && ((box.max - p).array() > margin).all();
  };
  for (int i = 0; i < 2000; ++i) {
    const auto draw = [&rng] { return static_cast<float>(rng.uniform(-1, 1)); };
    const Vector3f eye(draw(), draw(), 1.5f + draw());
    const Vector3f direction(draw(), draw(), draw());
    const Hit hit = world.cast(eye, direction);
    const Vector3f p = eye + hit.reach * direction;
    const int axis = hit.face / 2;
    EXPECT_NEAR(p[axis], hit.face % 2 == 0 ? hit.box->min[axis] : hit.box->max[axis], 1e-4);
    for (int step = 1; step < 50; ++step) {
      const Vector3f before = eye + hit.reach * (static_cast<float>(step) / 50) * direction;
      EXPECT_TRUE(inside(world.room(), before, -1e-4f));
      for (const Box& box : world.objects()) EXPECT_FALSE(inside(box, before, 1e-4f));
    }
  }
}

TEST(World, TexturesRunAlongTheRemainingAxes) {
  // A texture that is bright only at high u and low v.
  const Texture corner(2, 2, {0, 240, 0, 0});
  for (int axis = 0; axis < 3; ++axis) {
    Box room = plain_box({0, 0, 0}, {2, 2, 2}, 0);
    for (Surface& face : room.faces) face = {corner, 1, 0.5f};
    const World world(std::move(room), {});
    const int u = axis == 0 ? 1 : 0;
    const int v = axis == 2 ? 1 : 2;
    const Vector3f eye(1, 1, 1);
    Vector3f to_bright = Vector3f::Zero();
    to_bright[axis] = 1;
    to_bright[u] = 0.6f;
    to_bright[v] = -0.6f;
    const Vector3f to_dark = to_bright - 1.2f * Vector3f::Unit(u);
    EXPECT_FLOAT_EQ(World::grey(world.cast(eye, to_bright), eye, to_bright, 1e-3f), 120);
    EXPECT_FLOAT_EQ(World::grey(world.cast(eye, to_dark), eye, to_dark, 1e-3f), 0);
  }
}

TEST(Room, TheMiddleIsFree) {
  const World world = make_room(1, 0.05, 1);
  for (const Box& box : world.objects()) {
    const bool apart = box.min.x() >= 1.4f || box.max.x() <= -1.4f || box.min.y() >= 1.0f ||
                       box.max.y() <= -1.0f || box.min.z() >= 2.6f || box.max.z() <= 0.9f;
    EXPECT_TRUE(apart) << box.min.transpose() << " ... " << box.max.transpose();
    EXPECT_TRUE((box.min.array() >= world.room().min.array()).all());
    EXPECT_TRUE((box.max.array() <= world.room().max.array()).all());
  }
}

}  // namespace
}  // namespace leviosim::traces
