// Readers of pictures beside OpenCV's.
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "tests/support/image_files.h"
#include "tests/traces/test_folder.h"
#include "traces/datasets/image_file.h"

namespace leviosim::traces {
namespace {

cv::Mat picture() {
  cv::Mat image(24, 33, CV_8UC1);
  cv::randu(image, 0, 256);
  return image;
}

/// A grey PNG of 1, 2, 4 or 8 bits, whose bytes of packed pixels count up.
std::string packed_png(int bits, bool interlaced) {
  spng_ihdr header{};
  header.width = 33;
  header.height = 24;
  header.bit_depth = static_cast<std::uint8_t>(bits);
  header.color_type = SPNG_COLOR_TYPE_GRAYSCALE;
  header.interlace_method = static_cast<std::uint8_t>(interlaced ? 1 : 0);
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>((33 * bits + 7) / 8) * 24);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<std::uint8_t>(i * 29);
  return tests::png_of(pixels.data(), pixels.size(), header);
}

void expect_as_opencv(const std::string& bytes) {
  const cv::Mat raw(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<char*>(bytes.data()));
  const cv::Mat expected = cv::imdecode(raw, cv::IMREAD_UNCHANGED);
  ASSERT_EQ(expected.type(), CV_8UC1);
  const cv::Mat image = tests::decoded(bytes, tests::size_of(expected));
  ASSERT_EQ(image.size(), expected.size());
  EXPECT_EQ(cv::countNonZero(image != expected), 0);
}

TEST(ImageCodecs, PixelsOfGreyPngAreThoseOfOpenCv) {
  expect_as_opencv(tests::encoded(picture()));
  for (const int bits : {1, 2, 4, 8})
    for (const bool interlaced : {false, true}) {
      SCOPED_TRACE(fmt::format("{} bits, interlaced {}", bits, interlaced));
      expect_as_opencv(packed_png(bits, interlaced));
    }
}

TEST(ImageCodecs, PixelsOfGreyJpegAreThoseOfOpenCv) {
  for (const int quality : {30, 75, 100})
    for (const bool progressive : {false, true})
      expect_as_opencv(tests::jpeg_of(picture(), quality, progressive));
}

TEST(ImageCodecs, RecordedFrame) {
  const auto folder = testing::recorded_data() / "euroc/MH_01_easy_t05_t20/mav0/cam0/data";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not here";
  const auto file = std::filesystem::directory_iterator(folder)->path();
  expect_as_opencv(base::read_text_file(file));
}

}  // namespace
}  // namespace leviosim::traces
