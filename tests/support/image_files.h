// Pictures of OpenCV from and to files: PNG and JPEG of any depth and number of channels, for
// readers that are to refuse them, and the grey ones of ours.
#pragma once

#include <gtest/gtest.h>
#include <spng.h>
#include <turbojpeg.h>

#include <cstdlib>
#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "traces/datasets/image_file.h"

namespace leviosim::tests {

/// A PNG file of pixels that lie one row after the other as the format packs them.
inline std::string png_of(const void* pixels, std::size_t size, spng_ihdr header) {
  const std::unique_ptr<spng_ctx, void (*)(spng_ctx*)> context(spng_ctx_new(SPNG_CTX_ENCODER),
                                                               spng_ctx_free);
  EXPECT_EQ(spng_set_option(context.get(), SPNG_ENCODE_TO_BUFFER, 1), 0);
  EXPECT_EQ(spng_set_ihdr(context.get(), &header), 0);
  EXPECT_EQ(spng_encode_image(context.get(), pixels, size, SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE), 0);
  std::size_t bytes = 0;
  int status = 0;
  const std::unique_ptr<void, void (*)(void*)> png(
      spng_get_png_buffer(context.get(), &bytes, &status), std::free);
  EXPECT_EQ(status, 0);
  return {static_cast<const char*>(png.get()), bytes};
}

/// A PNG file of a picture of one or three channels of 8 or 16 bits.
inline std::string png_of(const cv::Mat& image) {
  spng_ihdr header{};
  header.width = static_cast<std::uint32_t>(image.cols);
  header.height = static_cast<std::uint32_t>(image.rows);
  header.bit_depth = image.depth() == CV_16U ? 16 : 8;
  header.color_type = image.channels() == 3 ? SPNG_COLOR_TYPE_TRUECOLOR : SPNG_COLOR_TYPE_GRAYSCALE;
  return png_of(image.data, image.total() * image.elemSize(), header);
}

/// A JPEG file of a picture of one or three channels of 8 bits.
inline std::string jpeg_of(const cv::Mat& image, int quality = 90, bool progressive = false) {
  const bool grey = image.channels() == 1;
  const std::unique_ptr<void, int (*)(tjhandle)> encoder(tjInitCompress(), tjDestroy);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  EXPECT_EQ(
      tjCompress2(encoder.get(), image.data, image.cols, static_cast<int>(image.step), image.rows,
                  grey ? TJPF_GRAY : TJPF_RGB, &bytes, &size, grey ? TJSAMP_GRAY : TJSAMP_444,
                  quality, progressive ? TJFLAG_PROGRESSIVE : 0),
      0);
  const std::unique_ptr<unsigned char, void (*)(unsigned char*)> jpeg(bytes, tjFree);
  return {reinterpret_cast<const char*>(jpeg.get()), size};
}

inline traces::ImageSize size_of(const cv::Mat& image) { return {image.cols, image.rows}; }
inline std::span<const std::uint8_t> pixels_of(const cv::Mat& image) {
  EXPECT_TRUE(image.type() == CV_8UC1 && image.isContinuous());
  return {image.data, image.total()};
}
inline std::string encoded(const cv::Mat& image) {
  return traces::encode_png(size_of(image), pixels_of(image));
}
inline cv::Mat decoded(std::string_view bytes, traces::ImageSize size) {
  const std::vector<std::uint8_t> pixels = traces::decode_gray(bytes, size);
  return cv::Mat(pixels, true).reshape(1, size.height);
}

}  // namespace leviosim::tests
