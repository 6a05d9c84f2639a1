// Statistics of images where what they should be is known: pictures with noise, blur and light that
// were put into them, points at known depths, and a drawn flight.
#include "tools/app/images/image_statistics.h"
#include "tools/app/images/picture_figures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "tests/traces/test_folder.h"
#include "tools/app/images/feature_tracks.h"
#include "tools/app/images/track_geometry.h"
#include "traces/datasets/asl_reader.h"
#include "traces/datasets/rng.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

using traces::GrayImage;

GrayImage picture(const std::function<double(int, int)>& grey) {
  GrayImage image{160, 120, {}, 0};
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      image.pixels.push_back(
          static_cast<std::uint8_t>(std::clamp(std::round(grey(x, y)), 0.0, 255.0)));
  return image;
}

TEST(PictureFigures, TellNoiseBesideTexture) {
  for (const double noise : {2.0, 6.0}) {
    traces::Rng rng(1);
    // A checker in the left half; what is left is smooth.
    const GrayImage image = picture([&](int x, int y) {
      const bool checker = x < 80 && (x / 3 + y / 3) % 2 == 0;
      return 100 + 0.3 * y + (checker ? 60 : 0) + noise * rng.normal();
    });
    EXPECT_NEAR(picture_figures(image).noise.value(), noise, 0.2 * noise);
  }
}

TEST(PictureFigures, TellTheWidthOfEdges) {
  // Edges 20 px apart, blurred by a normal distribution: the steepest slope is 1 / (2.507 sigma).
  for (const double sigma : {0.6, 0.9, 1.2}) {
    const GrayImage image = picture([&](int x, int) {
      const double from_edge = std::fmod(x, 20.0) - 10.5;
      const double bright = 0.5 * std::erfc(-from_edge / (sigma * std::sqrt(2.0)));
      return 40 + 160 * ((x / 20) % 2 == 0 ? bright : 1 - bright);
    });
    const double expected = 1 / std::erf(0.5 / (sigma * std::sqrt(2.0)));  // over one pixel
    EXPECT_NEAR(picture_figures(image).edge_width.value(), expected, 0.1 * expected) << sigma;
  }
}

TEST(PictureFigures, CountLight) {
  const PictureFigures figures = picture_figures(picture([](int x, int) {
    return x < 40 ? 10 : x < 60 ? 255 : 130;
  }));
  EXPECT_DOUBLE_EQ(figures.dark, 0.25);
  EXPECT_DOUBLE_EQ(figures.glare, 0.125);
  EXPECT_DOUBLE_EQ(figures.brightness, 0.25 * 10 + 0.125 * 255 + 0.625 * 130);
}

/// A camera that moves to the right by 5 cm a frame and looks at a point.
struct Moving {
  traces::PinholeIntrinsics camera{114, 114, 80, 60, 160, 120};
  std::vector<Eigen::Isometry3d> poses;
  Track track;

  explicit Moving(double depth, std::size_t frames = 8) {
    for (std::size_t i = 0; i < frames; ++i) {
      poses.emplace_back(
          Eigen::Translation3d(0.05 * static_cast<double>(i), 0, 0) *
          Eigen::AngleAxisd(0.01 * static_cast<double>(i), Eigen::Vector3d::UnitY()));
      const Eigen::Vector3d point = poses.back().inverse() * Eigen::Vector3d(0.1, -0.1, depth);
      FeatureSeen seen;
      seen.frame = i;
      seen.pixel = {camera.fx * point.x() / point.z() + camera.cx,
                    camera.fy * point.y() / point.z() + camera.cy};
      track.push_back(seen);
    }
  }
};

TEST(TrackGeometry, FindsDepthFromNearToFar) {
  for (const double depth : {0.3, 1.0, 3.0, 10.0}) {
    const Moving moving(depth);
    const auto geometry = track_geometry(moving.track, moving.poses, moving.camera).value();
    ASSERT_EQ(geometry.depths.size(), moving.track.size());
    EXPECT_NEAR(geometry.depths.front(), depth, 1e-3 * depth);
    for (const Eigen::Vector2d& error : geometry.errors) EXPECT_LT(error.norm(), 1e-3);
  }
}

TEST(TrackGeometry, FarPointsHaveErrorsButNoDepth) {
  const Moving moving(200);
  const auto geometry = track_geometry(moving.track, moving.poses, moving.camera).value();
  EXPECT_TRUE(geometry.depths.empty());
  EXPECT_EQ(geometry.errors.size(), moving.track.size());
}

TEST(TrackGeometry, OneWrongObservationIsTheOnlyOutlier) {
  Moving moving(2);
  moving.track[5].pixel += Eigen::Vector2d(3, 6);
  const auto geometry = track_geometry(moving.track, moving.poses, moving.camera).value();
  for (std::size_t i = 0; i < moving.track.size(); ++i)
    EXPECT_EQ(geometry.errors[i].norm() > kOutlierPx, i == 5) << i;
}

TEST(TrackGeometry, ShortTracksTellNothing) {
  const Moving moving(2, kFewestObservations - 1);
  EXPECT_FALSE(track_geometry(moving.track, moving.poses, moving.camera));
}

const ImageStatistic& row(const ImageStatistics& of, const std::string& name) {
  return *std::find_if(of.rows.begin(), of.rows.end(),
                       [&](const ImageStatistic& one) { return one.name == name; });
}

ImageStatistics of_flight(double duration_s, double noise) {
  const traces::testing::TempFolder folder;
  traces::write_synthetic_flight(folder / "flight",
                                 {.duration_s = duration_s, .image_noise = noise, .texel_m = 0.02});
  return image_statistics("flight", traces::open_asl(folder / "flight"), {160, 120});
}

TEST(ImageStatistics, OfADrawnFlightAreThoseOfItsRoom) {
  const ImageStatistics clear = of_flight(2.5, 1);
  EXPECT_EQ(clear.frames, 50u);
  // The path keeps to the middle of a room of 8 x 6 x 4 m, beginning after a second.
  EXPECT_GT(row(clear, "depth").count, 100u);
  EXPECT_GT(row(clear, "depth").tenth, 0.8);
  EXPECT_LT(row(clear, "depth").ninth_tenth, 8);
  EXPECT_LT(row(clear, "error against true poses").median, 0.5);
  const ImageStatistics noisy = of_flight(0.3, 5);
  for (const auto& [statistics, noise] : {std::pair{clear, 1.0}, {noisy, 5.0}}) {
    // Undistortion averages neighbouring pixels.
    EXPECT_GT(row(statistics, "noise").median, 0.5 * noise);
    EXPECT_LT(row(statistics, "noise").median, 1.2 * noise);
  }
  const std::vector<std::string> different = different_quantities(clear, noisy);
  EXPECT_NE(std::find(different.begin(), different.end(), "noise"), different.end());
  EXPECT_EQ(std::find(different.begin(), different.end(), "brightness"), different.end());
  EXPECT_TRUE(different_quantities(clear, clear).empty());
  EXPECT_NE(image_statistics_table({clear, noisy}).find("ratio"), std::string::npos);
}

TEST(ImageStatistics, WithoutTruePosesHaveThoseOfPicturesOnly) {
  const traces::testing::TempFolder folder;
  traces::write_synthetic_flight(folder / "flight", {.duration_s = 0.2, .texel_m = 0.05});
  traces::Dataset data = traces::open_asl(folder / "flight");
  data.ground_truth.clear();
  const ImageStatistics statistics = image_statistics("flight", data, {160, 120});
  EXPECT_EQ(row(statistics, "depth").count, 0u);
  EXPECT_EQ(row(statistics, "outliers").count, 0u);
  EXPECT_GT(row(statistics, "features").median, 50);
}

}  // namespace
}  // namespace leviosim::tools
