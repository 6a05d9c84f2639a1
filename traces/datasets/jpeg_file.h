// Grey pictures from the bytes of a JPEG file, sequential or progressive. A signal ends decoding
// within some rows, also of files whose many scans each pass over the whole picture.
// Left out: CMYK, which is refused; the size that a caller expects (image_file.h).
#pragma once

#include <csetjmp>
#include <cstdint>
#include <cstdio>  // for jpeglib.h
#include <span>
#include <string>
#include <string_view>

#include <jpeglib.h>

#include "traces/datasets/image_header.h"

namespace leviosim::traces {

class JpegFile {
 public:
  /// Reads the head. @param bytes  must outlive this
  /// @throws InputError if it is damaged or CMYK; std::bad_alloc
  explicit JpegFile(std::string_view bytes);
  JpegFile(const JpegFile&) = delete;
  JpegFile& operator=(const JpegFile&) = delete;

  ImageHeader header() const;

  /// Once. @param image  [height x width], 8-bit grey, row by row
  /// @throws InputError if the file is damaged, cut off or of more than 500 scans; Interrupted
  void decode(std::span<std::uint8_t> image);

 private:
  struct Decoder : jpeg_decompress_struct {
    Decoder() : jpeg_decompress_struct{} {}
    ~Decoder() { jpeg_destroy(reinterpret_cast<j_common_ptr>(this)); }
  };

  [[noreturn]] static void fail(j_common_ptr decoder);
  [[noreturn]] static void fail(j_common_ptr decoder, const char* reason);
  static void warn(j_common_ptr decoder, int level);
  static void poll(j_common_ptr decoder);
  template <class Body>
  void demand(const Body& body);

  jpeg_error_mgr errors_{};
  jpeg_progress_mgr progress_{};
  Decoder decoder_;
  std::jmp_buf end_of_call_;  ///< the library leaves a call by a jump over all frames between
  std::string reason_;        ///< of the last error
};

}  // namespace leviosim::traces
