// Pictures: the pixels that OpenCV reads, and an error as text for everything else.
#include "traces/datasets/image_file.h"

#include <gtest/gtest.h>
#include <spng.h>

#include <cstdlib>
#include <opencv2/imgcodecs.hpp>

#include "tests/traces/test_folder.h"

namespace leviosim::traces {
namespace {

using testing::expect_input_error;

cv::Mat picture() {
  cv::Mat image(24, 33, CV_8UC1);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      image.at<uchar>(y, x) = static_cast<uchar>((x * 37 + y * 91) % 251);
  return image;
}

std::string encoded(const char* extension, const cv::Mat& image,
                    const std::vector<int>& options = {}) {
  std::vector<uchar> bytes;
  EXPECT_TRUE(cv::imencode(extension, image, bytes, options));
  return {bytes.begin(), bytes.end()};
}

/// A grey PNG of 1, 2, 4 or 8 bits, whose bytes of packed pixels count up.
std::string packed_png(int bits, bool interlaced) {
  spng_ctx* const context = spng_ctx_new(SPNG_CTX_ENCODER);
  spng_set_option(context, SPNG_ENCODE_TO_BUFFER, 1);
  spng_ihdr header{33,
                   24,
                   static_cast<std::uint8_t>(bits),
                   SPNG_COLOR_TYPE_GRAYSCALE,
                   0,
                   0,
                   static_cast<std::uint8_t>(interlaced ? 1 : 0)};
  EXPECT_EQ(spng_set_ihdr(context, &header), 0);
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>((33 * bits + 7) / 8) * 24);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<std::uint8_t>(i * 29);
  EXPECT_EQ(
      spng_encode_image(context, pixels.data(), pixels.size(), SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE),
      0);
  std::size_t size = 0;
  int error = 0;
  void* const bytes = spng_get_png_buffer(context, &size, &error);
  std::string png(static_cast<const char*>(bytes), size);
  std::free(bytes);
  spng_ctx_free(context);
  return png;
}

void expect_as_opencv(const std::string& bytes) {
  const cv::Mat raw(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<char*>(bytes.data()));
  const cv::Mat expected = cv::imdecode(raw, cv::IMREAD_UNCHANGED);
  ASSERT_EQ(expected.type(), CV_8UC1);
  const cv::Mat image = decode_gray(bytes, expected.size());
  ASSERT_EQ(image.size(), expected.size());
  EXPECT_EQ(cv::countNonZero(image != expected), 0);
}

TEST(ImageFile, PixelsOfGreyPngAreThoseOfOpenCv) {
  expect_as_opencv(encoded(".png", picture()));
  for (const int bits : {1, 2, 4, 8})
    for (const bool interlaced : {false, true}) {
      SCOPED_TRACE(fmt::format("{} bits, interlaced {}", bits, interlaced));
      expect_as_opencv(packed_png(bits, interlaced));
    }
}

TEST(ImageFile, PixelsOfGreyJpegAreThoseOfOpenCv) {
  for (const int quality : {30, 75, 100})
    for (const int progressive : {0, 1})
      expect_as_opencv(
          encoded(".jpg", picture(),
                  {cv::IMWRITE_JPEG_QUALITY, quality, cv::IMWRITE_JPEG_PROGRESSIVE, progressive}));
}

TEST(ImageFile, RecordedFrame) {
  const auto folder = testing::recorded_data() / "euroc/MH_01_easy_t05_t20/mav0/cam0/data";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not here";
  const auto file = std::filesystem::directory_iterator(folder)->path();
  expect_as_opencv(base::read_text_file(file));
}

void expect_refused(const std::string& bytes, const std::string& part) {
  expect_input_error([&] { decode_gray(bytes, {33, 24}); }, {part});
}

TEST(ImageFile, WhatIsNotGreyIsRefused) {
  cv::Mat colour;
  cv::merge(std::vector<cv::Mat>{picture(), picture(), picture()}, colour);
  cv::Mat deep;
  picture().convertTo(deep, CV_16UC1, 257);
  expect_refused(encoded(".png", colour), "has 3 channels of 8 bits; expected 8-bit grey");
  expect_refused(encoded(".jpg", colour), "has 3 channels of 8 bits; expected 8-bit grey");
  expect_refused(encoded(".png", deep), "has 1 channel of 16 bits; expected 8-bit grey");
  expect_refused(encoded(".pgm", picture()), "neither PNG nor JPEG");
  expect_refused(encoded(".bmp", picture()), "neither PNG nor JPEG");
  expect_refused("", "neither PNG nor JPEG");
}

/// 4 GiB of pixels are announced by 33 bytes.
TEST(ImageFile, TheSizeIsCheckedBeforeThePixels) {
  expect_input_error(
      [] {
        decode_gray(encoded(".png", picture()), {32, 24});
      },
      {"is 33x24; sensor.yaml says 32x24"});
  expect_input_error(
      [] {
        decode_gray(encoded(".jpg", picture()), {33, 25});
      },
      {"is 33x24; sensor.yaml says 33x25"});
  const std::string head("\0\0\0\rIHDR\0\0\xff\xff\0\0\xff\xff\x08\0\0\0\0", 21);
  const std::string crc("\x93\x6e\x86\x8c", 4);
  expect_refused("\x89PNG\r\n\x1a\n" + head + crc, "is 65535x65535; sensor.yaml says 33x24");
}

TEST(ImageFile, EveryCutAndFlippedByteIsRefusedOrRead) {
  for (const std::string& whole : {encoded(".png", picture()), encoded(".jpg", picture())}) {
    // The checksum of the last, empty chunk of a PNG file says nothing about the pixels.
    const std::size_t needed = whole[0] == '\x89' ? whole.size() - 4 : whole.size();
    for (std::size_t size = 0; size < needed; ++size)
      EXPECT_THROW(decode_gray(whole.substr(0, size), {33, 24}), InputError) << size;
    int refused = 0;
    for (std::size_t i = 0; i < whole.size(); ++i) {
      std::string flipped = whole;
      flipped[i] = static_cast<char>(flipped[i] ^ 0x21);
      try {
        EXPECT_EQ(decode_gray(flipped, {33, 24}).size(), cv::Size(33, 24));
      } catch (const InputError& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
        ++refused;
      }
    }
    EXPECT_GT(refused, 10);
  }
}

}  // namespace
}  // namespace leviosim::traces
