// Pictures: pixels come back, and an error as text for everything else.
// Left out: comparisons with OpenCV (tests/validation/image_codecs_test.cpp).
#include "traces/datasets/image_file.h"

#include <gtest/gtest.h>

#include <ctime>
#include <opencv2/imgproc.hpp>

#include "tests/support/image_files.h"
#include "tests/traces/test_folder.h"

namespace leviosim::traces {
namespace {

using testing::expect_input_error;
using tests::decoded;
using tests::encoded;
using tests::jpeg_of;
using tests::png_of;

cv::Mat picture() {
  cv::Mat image(24, 33, CV_8UC1);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      image.at<uchar>(y, x) = static_cast<uchar>((x * 37 + y * 91) % 251);
  return image;
}

TEST(ImageFile, PixelsComeBack) {
  cv::Mat noise(120, 160, CV_8UC1);
  cv::randu(noise, 0, 256);
  for (const cv::Mat& image : {picture(), noise, cv::Mat(1, 1, CV_8UC1, 7.0)}) {
    const std::string png = encoded(image);
    EXPECT_EQ(png, encoded(image));
    EXPECT_EQ(cv::countNonZero(decoded(png, tests::size_of(image)) != image), 0);
  }
}

void expect_refused(const std::string& bytes, const std::string& part) {
  expect_input_error([&] { decode_gray(bytes, {33, 24}); }, {part});
}

/// As OpenCV rounds the luma of Rec. 601.
TEST(ImageFile, ColoursBecomeGrey) {
  cv::Mat colour(24, 33, CV_8UC3);  // red, green, blue
  cv::randu(colour, 0, 256);
  const cv::Mat grey = decoded(png_of(colour), {33, 24});
  cv::Mat expected;
  cv::cvtColor(colour, expected, cv::COLOR_RGB2GRAY);
  EXPECT_EQ(cv::countNonZero(grey != expected), 0);
  cv::Mat flat(24, 33, CV_8UC3, cv::Scalar(200, 100, 50));
  EXPECT_NEAR(decoded(jpeg_of(flat), {33, 24}).at<uchar>(12, 12), 124, 2);
}

/// As TUM-VI has them.
TEST(ImageFile, OfSixteenBitsTheUpperEightAreKept) {
  cv::Mat deep(24, 33, CV_16UC1);
  cv::randu(deep, 0, 65536);
  const cv::Mat grey = decoded(png_of(deep), {33, 24});
  for (int y = 0; y < grey.rows; ++y)
    for (int x = 0; x < grey.cols; ++x)
      EXPECT_EQ(grey.at<uchar>(y, x), deep.at<std::uint16_t>(y, x) >> 8);
}

TEST(ImageFile, TheSizeIsThatOfTheHead) {
  for (const std::string& bytes : {encoded(picture()), jpeg_of(picture())})
    EXPECT_EQ(image_size(bytes), (ImageSize{33, 24}));
  expect_input_error([] { image_size("no picture"); }, {"neither PNG nor JPEG"});
}

TEST(ImageFile, WhatIsNoPictureIsRefused) {
  expect_refused("P5 33 24 255\n" + std::string(33 * 24, 'x'), "neither PNG nor JPEG");
  expect_refused("BM" + std::string(33 * 24, 'x'), "neither PNG nor JPEG");
  expect_refused("", "neither PNG nor JPEG");
}

/// 4 GiB of pixels are announced by 45 bytes.
TEST(ImageFile, TheSizeIsCheckedBeforeThePixels) {
  expect_input_error(
      [] {
        decode_gray(encoded(picture()), {32, 24});
      },
      {"is 33x24; the camera's pictures are 32x24"});
  expect_input_error(
      [] {
        decode_gray(jpeg_of(picture()), {33, 25});
      },
      {"is 33x24; the camera's pictures are 33x25"});
  const std::string head("\0\0\0\rIHDR\0\0\xff\xff\0\0\xff\xff\x08\0\0\0\0", 21);
  const std::string crc("\x93\x6e\x86\x8c", 4);
  const std::string pixels("\0\0\0\0IDAT\x35\xaf\x06\x1e", 12);
  expect_refused("\x89PNG\r\n\x1a\n" + head + crc + pixels,
                 "is 65535x65535; the camera's pictures are 33x24");
}

/// Texts and profiles that would inflate to 1000 times their size, before the pixels and in number.
/// Nothing of them is built, so the work is that of reading their bytes.
TEST(ImageFile, WhatNoPixelNeedsIsPassedOver) {
  const std::string png = encoded(picture());
  const std::string bomb = tests::deflated(std::string(8'000'000, 'x'));
  const std::string latin = std::string("Comment\0\0", 9) + bomb;
  const std::string universal = std::string("Comment\0\1\0\0\0", 12) + bomb;
  for (const auto& [kind, content] : std::vector<std::pair<std::string, std::string>>{
           {"zTXt", latin},
           {"iTXt", universal},
           {"iCCP", latin},
           {"tEXt", std::string("Comment\0", 8) + std::string(100'000, 'x')},
           {"eXIf", std::string(50'000, 'x')},
           {"sPLT", std::string("p\0\x08", 3) + std::string(60'000, 'x')},
           {"abCd", std::string(100'000, 'x')}}) {
    std::string many = png;
    for (int i = 0; i < (kind == "iCCP" ? 1 : 300); ++i)
      many = tests::with_chunk(many, kind, content);
    const std::clock_t begin = std::clock();
    EXPECT_EQ(cv::countNonZero(decoded(many, {33, 24}) != picture()), 0) << kind;
    EXPECT_LT(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, 1) << kind;  // of work
  }
}

/// Each scan of a progressive file may pass over the whole picture.
TEST(ImageFile, ScansAreBounded) {
  const std::string jpeg = jpeg_of(picture(), 90, true);
  const std::size_t scan = jpeg.find("\xff\xda");
  const std::size_t next = jpeg.find("\xff\xda", scan + 1);
  std::string many = jpeg.substr(0, jpeg.size() - 2);
  const std::size_t last = jpeg.rfind("\xff\xda");
  for (int i = 0; i < 600; ++i) many += jpeg.substr(last, jpeg.size() - 2 - last);
  EXPECT_LT(scan, next);
  expect_refused(many + jpeg.substr(jpeg.size() - 2), "damaged JPEG");
  EXPECT_EQ(decoded(jpeg, {33, 24}).size(), picture().size());
}

TEST(ImageFile, EveryCutAndFlippedByteIsRefusedOrRead) {
  for (const std::string& whole : {encoded(picture()), jpeg_of(picture())}) {
    // The checksum of the last, empty chunk of a PNG file says nothing about the pixels.
    const std::size_t needed = whole[0] == '\x89' ? whole.size() - 4 : whole.size();
    for (std::size_t size = 0; size < needed; ++size)
      EXPECT_THROW(decode_gray(whole.substr(0, size), {33, 24}), InputError) << size;
    int refused = 0;
    for (std::size_t i = 0; i < whole.size(); ++i) {
      std::string flipped = whole;
      flipped[i] = static_cast<char>(flipped[i] ^ 0x21);
      try {
        EXPECT_EQ(decode_gray(flipped, {33, 24}).size(), 33u * 24);
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
