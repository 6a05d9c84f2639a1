#include "traces/datasets/jpeg_file.h"

#include <jerror.h>

#include <array>
#include <new>

#include "sim/base/interruption.h"

namespace leviosim::traces {
namespace {

constexpr int kMostScans = 500;

}  // namespace

void JpegFile::fail(j_common_ptr decoder, const char* reason) {
  auto& file = *static_cast<JpegFile*>(decoder->client_data);
  file.reason_ = reason;
  std::longjmp(file.end_of_call_, 1);
}

void JpegFile::fail(j_common_ptr decoder) {
  std::array<char, JMSG_LENGTH_MAX> reason;
  decoder->err->format_message(decoder, reason.data());
  fail(decoder, reason.data());
}

/// Warnings (level -1) are of damaged files, whose pixels would be guessed.
void JpegFile::warn(j_common_ptr decoder, int level) {
  if (level < 0) fail(decoder);
}

/// Called for each row of blocks of each scan.
void JpegFile::poll(j_common_ptr decoder) {
  if (pending_interrupt() != 0) fail(decoder, "interrupted");
  if (reinterpret_cast<j_decompress_ptr>(decoder)->input_scan_number > kMostScans)
    fail(decoder, "more than 500 scans");
}

/// @param body  holds no object that has a destructor
template <class Body>
void JpegFile::demand(const Body& body) {
  if (setjmp(end_of_call_) == 0) {
    body();
    return;
  }
  throw_if_interrupted();
  if (errors_.msg_code == JERR_OUT_OF_MEMORY) throw std::bad_alloc();
  refuse_damaged_image("JPEG", reason_);
}

JpegFile::JpegFile(std::string_view bytes) {
  decoder_.err = jpeg_std_error(&errors_);
  decoder_.client_data = this;
  errors_.error_exit = fail;
  errors_.emit_message = warn;
  demand([&] {
    jpeg_create_decompress(&decoder_);
    progress_.progress_monitor = poll;
    decoder_.progress = &progress_;
    jpeg_mem_src(&decoder_, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
    jpeg_read_header(&decoder_, TRUE);
  });
  if (decoder_.jpeg_color_space == JCS_CMYK || decoder_.jpeg_color_space == JCS_YCCK)
    throw InputError("has the colours of print (CMYK); expected grey, or red, green and blue");
}

ImageHeader JpegFile::header() const { return {decoder_.image_width, decoder_.image_height}; }

void JpegFile::decode(std::span<std::uint8_t> image) {
  demand([&] {
    decoder_.out_color_space = JCS_GRAYSCALE;
    jpeg_start_decompress(&decoder_);
    while (decoder_.output_scanline < decoder_.output_height) {
      JSAMPROW row = image.data() + std::size_t{decoder_.output_scanline} * decoder_.output_width;
      jpeg_read_scanlines(&decoder_, &row, 1);
    }
    jpeg_finish_decompress(&decoder_);
  });
}

}  // namespace leviosim::traces
