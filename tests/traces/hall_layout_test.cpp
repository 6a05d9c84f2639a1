#include "traces/synthesis/hall_layout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace leviosim::traces {
namespace {

using Eigen::Vector3d;

constexpr double kClearance = 0.8;

/// A wide loop with ups and downs, which leaves room in its middle.
std::vector<Vector3d> loop() {
  std::vector<Vector3d> path;
  for (double s = 0; s < 6.28; s += 0.01)
    path.emplace_back(5 * std::cos(s) - 20, 4 * std::sin(s) + 7, 0.8 * std::sin(3 * s) - 1);
  return path;
}

double clearance(const HallLayout& layout, const Vector3d& position) {
  double nearest = std::min((position - layout.hall.min()).minCoeff(),
                            (layout.hall.max() - position).minCoeff());
  for (const HallObject& object : layout.objects)
    nearest = std::min(nearest, object.box.exteriorDistance(position));
  return nearest;
}

TEST(HallLayout, KeepsThePathClear) {
  const std::vector<Vector3d> path = loop();
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const HallLayout layout = lay_out_hall(path, kClearance, seed);
    double nearest = 1e9;
    for (const Vector3d& position : path) nearest = std::min(nearest, clearance(layout, position));
    EXPECT_GE(nearest, kClearance) << seed;
    EXPECT_LT(nearest, 1.5) << "something should be near, seed " << seed;
  }
}

TEST(HallLayout, HasStructureAtManyDepthsOnAllSides) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const HallLayout layout = lay_out_hall(loop(), kClearance, seed);
    EXPECT_GT(layout.objects.size(), 80u);
    int free_standing = 0;
    for (const HallObject& object : layout.objects) {
      const Vector3d gap =
          (object.box.min() - layout.hall.min()).cwiseMin(layout.hall.max() - object.box.max());
      free_standing += gap.x() > 1 && gap.y() > 1;
    }
    EXPECT_GT(free_standing, 15) << seed;
  }
}

TEST(HallLayout, ThingsStandInTheHallAndNotInEachOther) {
  const HallLayout layout = lay_out_hall(loop(), kClearance, 3);
  constexpr double kTouching = 1e-5;
  for (std::size_t i = 0; i < layout.objects.size(); ++i) {
    const Eigen::AlignedBox3d& box = layout.objects[i].box;
    EXPECT_GT(box.sizes().minCoeff(), 0.01);
    const Eigen::AlignedBox3d core(box.min().array() + kTouching, box.max().array() - kTouching);
    EXPECT_TRUE(layout.hall.contains(core));
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_FALSE(core.intersects(layout.objects[j].box)) << i << " " << j;
  }
}

TEST(HallLayout, FollowsFromTheSeed) {
  const HallLayout a = lay_out_hall(loop(), kClearance, 1);
  const HallLayout again = lay_out_hall(loop(), kClearance, 1);
  const HallLayout b = lay_out_hall(loop(), kClearance, 2);
  ASSERT_EQ(a.objects.size(), again.objects.size());
  for (std::size_t i = 0; i < a.objects.size(); ++i)
    EXPECT_EQ(a.objects[i].box.min(), again.objects[i].box.min());
  EXPECT_NE(a.hall.min(), b.hall.min());
}

TEST(WorkshopLayout, HasThingsNearThePathAndNoneTooNear) {
  constexpr double kNear = 0.3;
  const std::vector<Vector3d> path = loop();
  for (std::uint64_t seed = 1; seed < 4; ++seed) {
    const HallLayout layout = lay_out_workshop(path, kNear, seed);
    std::size_t near = 0;
    for (const Vector3d& position : path) {
      EXPECT_GE(clearance(layout, position), kNear - 1e-9) << seed;
      near += clearance(layout, position) < 0.8 ? 1 : 0;
    }
    EXPECT_GT(near, path.size() / 2) << "tables below the path, seed " << seed;
    for (const SurfaceStyle style : {SurfaceStyle::timber, SurfaceStyle::net, SurfaceStyle::cloth,
                                     SurfaceStyle::metal, SurfaceStyle::stack})
      EXPECT_TRUE(std::any_of(layout.objects.begin(), layout.objects.end(),
                              [&](const HallObject& o) { return o.style == style; }));
  }
}

TEST(WorkshopLayout, FollowsFromTheSeed) {
  const auto corners = [](std::uint64_t seed) {
    std::vector<double> all;
    for (const HallObject& object : lay_out_workshop(loop(), 0.3, seed).objects)
      for (const double x : object.box.min()) all.push_back(x);
    return all;
  };
  EXPECT_EQ(corners(1), corners(1));
  EXPECT_NE(corners(1), corners(2));
}

TEST(SurroundLayout, IsAtItsDistanceAlongTheWholePath) {
  const std::vector<Vector3d> path = loop();
  for (const double distance : {1.0, 3.0, 10.0, 30.0}) {
    const HallLayout layout = lay_out_surround(path, distance, 1);
    for (const Vector3d& position : path) {
      EXPECT_GE(clearance(layout, position), 0.999 * distance);
      EXPECT_LT(clearance(layout, position), 2 * distance);
    }
  }
}

}  // namespace
}  // namespace leviosim::traces
