// Pictures of OpenCV from and to files: PNG and JPEG of any depth and number of channels, for
// readers that are to refuse them, and the grey ones of ours.
#pragma once

#include <gtest/gtest.h>
#include <spng.h>
#include <zlib.h>

#include <cstdio>  // for jpeglib.h
#include <cstdlib>
#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include <jpeglib.h>

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

/// What a PNG chunk of texts or profiles holds.
inline std::string deflated(const std::string& text) {
  uLongf size = compressBound(text.size());
  std::string bytes(size, '\0');
  EXPECT_EQ(compress(reinterpret_cast<Bytef*>(bytes.data()), &size,
                     reinterpret_cast<const Bytef*>(text.data()), text.size()),
            Z_OK);
  bytes.resize(size);
  return bytes;
}

/// A PNG file with one more chunk, behind its head.
inline std::string with_chunk(const std::string& png, const std::string& kind,
                              const std::string& content) {
  const auto number = [](std::size_t value) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xff);
    return bytes;
  };
  const std::string body = kind + content;
  const auto crc =
      crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
  std::string bytes = png;
  constexpr std::size_t kHead = 8 + 25;
  return bytes.insert(kHead, number(content.size()) + body + number(crc));
}

/// A JPEG file of a picture of one or three channels of 8 bits.
inline std::string jpeg_of(const cv::Mat& image, int quality = 90, bool progressive = false) {
  const bool grey = image.channels() == 1;
  jpeg_error_mgr errors;
  jpeg_compress_struct encoder{};
  encoder.err = jpeg_std_error(&errors);
  jpeg_create_compress(&encoder);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&encoder, &bytes, &size);
  encoder.image_width = static_cast<JDIMENSION>(image.cols);
  encoder.image_height = static_cast<JDIMENSION>(image.rows);
  encoder.input_components = image.channels();
  encoder.in_color_space = grey ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_set_defaults(&encoder);
  jpeg_set_quality(&encoder, quality, TRUE);
  for (int i = 0; i < encoder.num_components; ++i)  // colours as fine as brightness
    encoder.comp_info[i].h_samp_factor = encoder.comp_info[i].v_samp_factor = 1;
  if (progressive) jpeg_simple_progression(&encoder);
  jpeg_start_compress(&encoder, TRUE);
  for (int y = 0; y < image.rows; ++y) {
    JSAMPROW row = const_cast<uchar*>(image.ptr(y));
    jpeg_write_scanlines(&encoder, &row, 1);
  }
  jpeg_finish_compress(&encoder);
  jpeg_destroy_compress(&encoder);
  const std::unique_ptr<unsigned char, void (*)(void*)> jpeg(bytes, std::free);
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
