// Pictures against the camera model: what project() says must be where render() draws it.
#include "traces/synthesis/renderer.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "traces/datasets/euroc_sensors.h"
#include "traces/datasets/rng.h"

namespace leviosim::traces {
namespace {

using Eigen::Vector3d;

constexpr double kPlateX = 2.5;
constexpr double kPlateHalf = 0.15;

/// White plates on a 5x3 grid in front of a black room.
struct Plates {
  std::vector<Vector3d> centres;
  World world;

  Plates() : centres(grid()), world(plain_box({-4, -4, -4}, {4, 4, 4}, 0), boxes(centres)) {}

  static std::vector<Vector3d> grid() {
    std::vector<Vector3d> result;
    for (const double y : {-1.6, -0.8, 0.0, 0.8, 1.6})
      for (const double z : {-0.9, 0.0, 0.9}) result.emplace_back(kPlateX, y, z);
    return result;
  }
  static std::vector<Box> boxes(const std::vector<Vector3d>& centres) {
    std::vector<Box> result;
    for (const Vector3d& c : centres) {
      const Vector3d half(0, kPlateHalf, kPlateHalf);
      const Vector3d max = c + half + Vector3d(0.001, 0, 0);
      result.push_back(plain_box((c - half).cast<float>(), max.cast<float>(), 255));
    }
    return result;
  }
};

/// A camera near the origin that looks along x, slightly turned about each axis.
Eigen::Isometry3d camera_pose() {
  Eigen::Matrix3d ahead;  // columns: camera x (right), y (down), z (forward)
  ahead << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return Eigen::Translation3d(0.1, -0.05, 0.08) *
         Eigen::AngleAxisd(0.1, Vector3d(1, 2, 3).normalized()) * Eigen::Isometry3d(ahead);
}

TEST(Renderer, DrawsPointsWhereTheCameraModelProjectsThem) {
  const Plates plates;
  const CameraModel camera = euroc_cam0();
  const Renderer renderer(plates.world, camera, {0, 0, 1});
  const Eigen::Isometry3d pose = camera_pose();
  const std::vector<std::uint8_t> picture = renderer.render(pose, 0);
  // A point this far inside or outside its plate stays so when it is rounded to a pixel centre,
  // with less than half a pixel to spare: a picture off by half a pixel would be found out.
  const double margin = 0.75 * 2.5 / camera.fx;
  Rng rng(1);
  int inside_points = 0;
  int outside_points = 0;
  for (const Vector3d& centre : plates.centres) {
    for (int i = 0; i < 2000; ++i) {
      const Vector3d offset(0, rng.uniform(-1.2, 1.2) * kPlateHalf,
                            rng.uniform(-1.2, 1.2) * kPlateHalf);
      const double reach = std::max(std::abs(offset.y()), std::abs(offset.z()));
      if (std::abs(reach - kPlateHalf) < margin) continue;
      const Eigen::Vector2d pixel = camera.project(pose.inverse() * (centre + offset));
      const auto x = std::lround(pixel.x());
      const auto y = std::lround(pixel.y());
      if (x < 0 || y < 0 || x >= camera.width || y >= camera.height) continue;
      const bool inside = reach < kPlateHalf;
      ++(inside ? inside_points : outside_points);
      ASSERT_EQ(picture[static_cast<std::size_t>(y) * camera.width + x], inside ? 255 : 0)
          << pixel.transpose();
    }
  }
  EXPECT_GT(inside_points, 10'000);
  EXPECT_GT(outside_points, 3'000);
}

TEST(Renderer, TilesDropNothingThatIsVisible) {
  // Many boxes, seen from everywhere: the picture must equal one cast against all objects.
  Rng rng(2);
  std::vector<Box> boxes;
  for (int i = 0; i < 40; ++i) {
    const Eigen::Vector3f centre(static_cast<float>(rng.uniform(-3, 3)),
                                 static_cast<float>(rng.uniform(-3, 3)),
                                 static_cast<float>(rng.uniform(-3, 3)));
    if (centre.norm() < 1) continue;
    const float half = static_cast<float>(rng.log_uniform(0.01, 0.4));
    boxes.push_back(plain_box(centre.array() - half, centre.array() + half,
                              static_cast<std::uint8_t>(50 + 5 * i)));
  }
  const World world(plain_box({-4, -4, -4}, {4, 4, 4}, 10), std::move(boxes));
  CameraModel camera = euroc_cam0();
  camera.fx /= 6, camera.fy /= 6, camera.cx /= 6, camera.cy /= 6;
  camera.width = 125, camera.height = 80;
  const Renderer renderer(world, camera, {0, 0, 1});
  for (int i = 0; i < 6; ++i) {
    const Eigen::Isometry3d pose(
        Eigen::AngleAxisd(i, Vector3d(rng.normal(), rng.normal(), rng.normal()).normalized()));
    const auto picture = renderer.render(pose, 0);
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        const Eigen::Vector3d ray = camera.unproject({x, y}).homogeneous();
        const Eigen::Vector3f direction = pose.linear().cast<float>() * ray.cast<float>();
        const Eigen::Vector3f origin = Eigen::Vector3f::Zero();
        const float grey = World::grey(world.cast(origin, direction), origin, direction, 1e-3f);
        ASSERT_EQ(picture[static_cast<std::size_t>(y) * camera.width + x],
                  static_cast<std::uint8_t>(grey));
      }
    }
  }
}

TEST(Renderer, NoiseAndVignettingAreAsAskedFor) {
  const World world(plain_box({-4, -4, -4}, {4, 4, 4}, 120), {});
  const CameraModel camera = euroc_cam0();
  const Renderer noisy(world, camera, {2.0, 0, 7});
  const auto a = noisy.render(camera_pose(), 0);
  double sum = 0, squares = 0;
  for (const std::uint8_t value : a) {
    sum += value - 120.0;
    squares += (value - 120.0) * (value - 120.0);
  }
  const auto count = static_cast<double>(a.size());
  EXPECT_NEAR(sum / count, 0, 0.1);
  EXPECT_NEAR(std::sqrt(squares / count), std::sqrt(4 + 1.0 / 12), 0.1);
  EXPECT_EQ(a, noisy.render(camera_pose(), 0));
  EXPECT_NE(a, noisy.render(camera_pose(), 1)) << "each frame has its own noise";

  const auto dim = Renderer(world, camera, {0, 0.3, 7}).render(camera_pose(), 0);
  EXPECT_EQ(dim[0], 84) << "the corner loses 30 %";
  EXPECT_EQ(dim[240 * 752 + 376], 120);
}

TEST(Renderer, DrawnPixelsAreThoseOfTheWholePicture) {
  const Plates plates;
  const CameraModel camera = euroc_cam0();
  RenderOptions options;
  const auto whole = Renderer(plates.world, camera, options).render(camera_pose(), 3);
  Rng rng(4);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x)
      options.wanted.push_back(y > 100 && x < 600 && rng.chance(0.2) ? 1 : 0);
  const auto part = Renderer(plates.world, camera, options).render(camera_pose(), 3);
  for (std::size_t i = 0; i < whole.size(); ++i)
    ASSERT_EQ(part[i], options.wanted[i] != 0 ? whole[i] : 0) << i;
}

TEST(Renderer, AveragesThePosesOfAnExposure) {
  const Plates plates;
  const Renderer renderer(plates.world, euroc_cam0(), {0, 0, 1});
  const std::array<Eigen::Isometry3d, 2> poses{
      camera_pose(), camera_pose() * Eigen::AngleAxisd(0.02, Vector3d::UnitY())};
  const auto both = renderer.render({poses, 1, 0});
  const auto first = renderer.render(poses[0], 0), second = renderer.render(poses[1], 0);
  int half_lit = 0;
  for (std::size_t i = 0; i < both.size(); ++i) {
    ASSERT_EQ(both[i], (first[i] + second[i] + 1) / 2);
    half_lit += both[i] == 128;
  }
  EXPECT_GT(half_lit, 1000);
}

TEST(Renderer, TheSpotAveragesSurfaces) {
  // A fine checkerboard on the walls turns grey when the spot covers several of its squares.
  Box room = plain_box({-4, -4, -4}, {4, 4, 4}, 0);
  std::vector<std::uint8_t> checker;
  for (int i = 0; i < 512 * 512; ++i) checker.push_back((i + i / 512) % 2 == 0 ? 0 : 200);
  for (Surface& face : room.faces) face = {Texture(512, 512, checker), 64, 1};
  const World world(room, {});
  const auto contrast = [&](double spot_px) {
    RenderOptions options{.noise = 0, .vignetting = 0, .seed = 1, .spot_px = spot_px, .wanted = {}};
    double sum = 0;
    for (const std::uint8_t grey : Renderer(world, euroc_cam0(), options).render(camera_pose(), 0))
      sum += std::abs(grey - 100.0) / (752 * 480);
    return sum;
  };
  EXPECT_GT(contrast(1), 20);
  EXPECT_LT(contrast(10), 3);
}

TEST(Renderer, GainScalesTheLightBeforeTheNoise) {
  const World world(plain_box({-4, -4, -4}, {4, 4, 4}, 120), {});
  const Eigen::Isometry3d pose = camera_pose();
  const Renderer quiet(world, euroc_cam0(), {0, 0, 1});
  EXPECT_EQ(quiet.render({{&pose, 1}, 0.25f, 0})[5], 30);
  const auto dark = Renderer(world, euroc_cam0(), {2, 0, 1}).render({{&pose, 1}, 0.25f, 0});
  double squares = 0;
  for (const std::uint8_t value : dark) squares += (value - 30.0) * (value - 30.0);
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(dark.size())), 2, 0.1);
}

TEST(Renderer, ShotNoiseRisesWithTheRootOfTheLight) {
  const auto deviation = [](std::uint8_t grey) {
    const World room(plain_box({-4, -4, -4}, {4, 4, 4}, grey), {});
    const Renderer renderer(room, euroc_cam0(),
                            {.noise = 1, .vignetting = 0, .seed = 1, .shot_noise = 4});
    double sum = 0, squares = 0;
    const std::vector<std::uint8_t> picture = renderer.render(camera_pose(), 0);
    for (const std::uint8_t pixel : picture) {
      sum += pixel;
      squares += pixel * pixel;
    }
    const auto count = static_cast<double>(picture.size());
    return std::sqrt(squares / count - sum / count * sum / count);
  };
  for (const int grey : {32, 128})
    EXPECT_NEAR(deviation(static_cast<std::uint8_t>(grey)), std::sqrt(1 + 16 * grey / 128.0), 0.1);
}

TEST(Renderer, GlossIsALampThatOnlySomeViewsSee) {
  Box plate = plain_box({-1, -1, 0}, {1, 1, 0.1f}, 100);
  for (Surface& face : plate.faces) face.gloss = 100;
  const World world(plain_box({-9, -9, -9}, {9, 9, 9}, 0), {plate});
  const auto seen = [&](const Eigen::Vector3f& from) {
    const Hit hit = world.cast(from, -from);
    return World::grey(hit, from, -from, 1e-3f);
  };
  const Eigen::Vector3f lamp(0.5f, 0.35f, 0.79f);
  const Eigen::Vector3f mirrored(-0.5f, -0.35f, 0.79f);
  EXPECT_NEAR(seen(3 * mirrored), 200, 2);
  EXPECT_NEAR(seen(3 * lamp), 100, 10);
  EXPECT_LT(seen(3 * lamp), seen(3 * mirrored));
}

/// Mean grey level of a picture of walls of one grey level.
double mean_of_walls(std::uint8_t grey, double exposed_to, float gain) {
  const World world(plain_box({-4, -4, -4}, {4, 4, 4}, grey), {});
  const CameraModel camera = euroc_cam0();
  const Renderer renderer(world, camera, {.noise = 0, .vignetting = 0, .exposed_to = exposed_to});
  const Eigen::Isometry3d pose = camera_pose();
  double sum = 0;
  const auto picture = renderer.render({.T_world_camera = {&pose, 1}, .gain = gain, .frame = 0});
  for (const std::uint8_t pixel : picture) sum += pixel;
  return sum / static_cast<double>(picture.size());
}

TEST(Renderer, ExposesPicturesToAMeanWithinLimits) {
  EXPECT_DOUBLE_EQ(mean_of_walls(50, 0, 1), 50) << "fixed";
  EXPECT_NEAR(mean_of_walls(50, 130, 1), 130, 1);
  EXPECT_NEAR(mean_of_walls(200, 130, 1), 130, 1);
  EXPECT_NEAR(mean_of_walls(50, 130, 0.8f), 130, 1) << "whatever light there is";
  EXPECT_NEAR(mean_of_walls(10, 130, 1), 10 * kMostExposure, 1) << "too dark";
}

}  // namespace
}  // namespace leviosim::traces
