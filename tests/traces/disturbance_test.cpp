// Disturbances of data sets: each does what its name says, the same every time.
#include "traces/datasets/disturbance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/traces/test_folder.h"
#include "traces/datasets/asl_reader.h"
#include "traces/datasets/image_source.h"

namespace leviosim::traces {
namespace {

using testing::AslFolder;
using testing::expect_input_error;

/// `count` frames at 20 Hz and samples at 200 Hz.
Dataset dataset(int count) {
  Dataset data;
  data.camera.fx = data.camera.fy = 100;
  data.camera.rate_hz = 20;
  for (int i = 0; i < count; ++i)
    data.frames.push_back({i * std::int64_t{50'000'000}, std::to_string(i), std::size_t(i)});
  for (int i = 0; i < 10 * count; ++i)
    data.imu.push_back({i * std::int64_t{5'000'000}, {0.1, 0, 0}, {0, 0, 10}});
  return data;
}

Dataset disturbed(int count, const char* text) {
  Dataset data = dataset(count);
  disturb(data, parse_disturbance(text));
  return data;
}

std::vector<std::uint8_t> picture(const char* text, double t_s, std::uint8_t grey = 100) {
  std::vector<std::uint8_t> pixels(160 * 120, grey);
  const auto t_ns = static_cast<std::int64_t>(1e9 * t_s);
  disturb_picture(parse_disturbance(text), {t_ns, 0, 10'000'000'000}, 160, pixels);
  return pixels;
}

TEST(Disturbance, IsReadAsItIsWritten) {
  for (const char* text : {"none", "noise=10", "imu-delay=-5", "gyro-bias=0.05"})
    EXPECT_EQ(parse_disturbance(text).text(), text);
  expect_input_error([] { parse_disturbance("nosie=1"); }, {"'nosie=1'", "did you mean 'noise'"});
  expect_input_error([] { parse_disturbance("noise"); }, {"noise=VALUE", "from 0 to 100"});
  expect_input_error([] { parse_disturbance("noise=x"); }, {"noise=VALUE", "grey levels"});
  expect_input_error([] { parse_disturbance("noise=nan"); }, {"from 0 to 100"});
  expect_input_error([] { parse_disturbance("every-nth=2.5"); }, {"whole number from 2"});
}

TEST(Disturbance, LosesFrames) {
  EXPECT_NEAR(static_cast<double>(disturbed(4000, "frames-dropped=10").frames.size()), 3600, 60);
  EXPECT_EQ(disturbed(400, "frames-dropped=90").frames.front().t_ns, 0) << "never the first";
  const Dataset half = disturbed(100, "every-nth=2");
  ASSERT_EQ(half.frames.size(), 50u);
  EXPECT_EQ(half.frames[7].path, "14");
  EXPECT_EQ(half.camera.rate_hz, 10);
  const Dataset bursts = disturbed(200, "burst=4");
  EXPECT_NEAR(static_cast<double>(bursts.frames.size()), 160, 1);
  std::int64_t longest = 0;
  for (std::size_t i = 1; i < bursts.frames.size(); ++i)
    longest = std::max(longest, bursts.frames[i].t_ns - bursts.frames[i - 1].t_ns);
  EXPECT_GE(longest, 250'000'000);
  EXPECT_EQ(bursts.frames.size(), disturbed(200, "burst=4").frames.size());
}

TEST(Disturbance, FreezesTheMiddle) {
  const Dataset data = disturbed(200, "frozen=2");
  std::size_t frozen = 0;
  for (std::size_t i = 0; i < 200; ++i) {
    EXPECT_EQ(data.frames[i].t_ns, static_cast<std::int64_t>(i) * 50'000'000);
    frozen += data.frames[i].path != std::to_string(i) ? 1 : 0;
  }
  EXPECT_EQ(frozen, 40u);
  EXPECT_EQ(data.frames[80].path, data.frames[119].path);
  EXPECT_EQ(data.frames[121].path, "121");
}

TEST(Disturbance, IsOfTheImuOrTheCalibration) {
  EXPECT_EQ(disturbed(2, "imu-delay=5").imu[3].t_ns, 20'000'000);
  EXPECT_EQ(disturbed(2, "imu-delay=-5").imu[3].t_ns, 10'000'000);
  EXPECT_NEAR((disturbed(2, "gyro-bias=0.05").imu[0].gyro - Eigen::Vector3d(0.1, 0, 0)).norm(),
              0.05, 1e-12);
  EXPECT_NEAR(disturbed(2, "accel-scale=2").imu[0].accel.z(), 10.2, 1e-12);
  EXPECT_NEAR(disturbed(2, "focal-length=-2").camera.fx, 98, 1e-12);
}

TEST(Disturbance, IsOfThePicture) {
  EXPECT_EQ(picture("brightness-steps=50", 0.5)[0], 100);
  EXPECT_EQ(picture("brightness-steps=50", 1.5)[0], 50);
  EXPECT_EQ(picture("dark=2", 3.9)[0], 100);
  EXPECT_EQ(picture("dark=2", 4.1)[0], 2);
  EXPECT_EQ(picture("dark=2", 6.1)[0], 100);
  const auto noisy = picture("noise=10", 1);
  double sum = 0, squares = 0;
  for (const std::uint8_t pixel : noisy) {
    sum += pixel - 100.0;
    squares += (pixel - 100.0) * (pixel - 100.0);
  }
  const auto count = static_cast<double>(noisy.size());
  EXPECT_NEAR(sum / count, 0, 0.4);
  EXPECT_NEAR(std::sqrt(squares / count), 10, 0.3);
  EXPECT_EQ(noisy, picture("noise=10", 1));
  EXPECT_NE(noisy, picture("noise=10", 1.05));
  const auto black = picture("occlusion-black=30", 0);
  EXPECT_EQ(std::count(black.begin(), black.end(), 0), 160 * 36);
  EXPECT_EQ(black.front(), 100);
  EXPECT_EQ(black.back(), 0);
  EXPECT_EQ(picture("occlusion-textured=30", 0), picture("occlusion-textured=30", 7)) << "static";
  EXPECT_NE(picture("occlusion-textured=30", 0), picture("none", 0));
  const auto object = picture("moving-object=12", 0), later = picture("moving-object=12", 0.75);
  const auto covered = [](const auto& pixels) {
    return std::count_if(pixels.begin(), pixels.end(), [](auto pixel) { return pixel != 100; });
  };
  EXPECT_NEAR(static_cast<double>(covered(object)), 0.12 * 160 * 120, 0.01 * 160 * 120);
  EXPECT_EQ(covered(object), covered(later));
  for (int i = 0; i < 30; ++i)  // a quarter round: from the right of the middle to below it
    EXPECT_EQ(object[static_cast<std::size_t>(60 * 160 + 110 + i - 15)],
              later[static_cast<std::size_t>(90 * 160 + 80 + i - 15)]);
}

TEST(Disturbance, ReachesPicturesThatAreRead) {
  const AslFolder folder;
  OpenOptions options;
  options.disturbance = parse_disturbance("occlusion-black=100");
  const Dataset dark = open_asl(folder.root(), options);
  for (const std::uint8_t pixel : ImageSource(dark, {16, 12}).read(1).pixels) EXPECT_EQ(pixel, 0);
}

}  // namespace
}  // namespace leviosim::traces
