#include "traces/datasets/jpeg_encoder.h"

#include <csetjmp>
#include <cstddef>
#include <cstdio>  // for jpeglib.h
#include <cstdlib>
#include <memory>
#include <new>

#include <jpeglib.h>

namespace leviosim::traces {
namespace {

/// The library leaves a call by a jump, which only lack of memory makes it do here.
struct Encoder : jpeg_compress_struct {
  Encoder() : jpeg_compress_struct{} {
    err = jpeg_std_error(&errors);
    errors.error_exit = [](j_common_ptr encoder) {
      std::longjmp(static_cast<Encoder*>(encoder->client_data)->end_of_call, 1);
    };
    client_data = this;
  }
  ~Encoder() {
    jpeg_destroy(reinterpret_cast<j_common_ptr>(this));
    std::free(bytes);
  }

  /// @returns whether all went well. Holds no object that has a destructor.
  bool encode(const std::uint8_t* pixels, int width, int height, int quality) {
    if (setjmp(end_of_call) != 0) return false;
    jpeg_create_compress(this);
    jpeg_mem_dest(this, &bytes, &size);
    image_width = static_cast<JDIMENSION>(width);
    image_height = static_cast<JDIMENSION>(height);
    input_components = 1;
    in_color_space = JCS_GRAYSCALE;
    jpeg_set_defaults(this);
    jpeg_set_quality(this, quality, TRUE);
    optimize_coding = TRUE;
    jpeg_start_compress(this, TRUE);
    while (next_scanline < image_height) {
      JSAMPROW row = const_cast<JSAMPROW>(pixels + std::size_t{next_scanline} * image_width);
      jpeg_write_scanlines(this, &row, 1);
    }
    jpeg_finish_compress(this);
    return true;
  }

  jpeg_error_mgr errors{};
  std::jmp_buf end_of_call{};
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
};

}  // namespace

std::string jpeg_bytes(std::span<const std::uint8_t> pixels, int width, int height, int quality) {
  const auto encoder = std::make_unique<Encoder>();
  if (!encoder->encode(pixels.data(), width, height, quality)) throw std::bad_alloc();
  return {reinterpret_cast<const char*>(encoder->bytes), encoder->size};
}

}  // namespace leviosim::traces
