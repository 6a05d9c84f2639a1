#include "traces/datasets/image_file.h"

#include <fmt/core.h>
#include <png.h>
#include <zlib.h>

#include <algorithm>
#include <csetjmp>
#include <cstdlib>
#include <memory>
#include <new>
#include <opencv2/imgproc.hpp>
#include <string>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "sim/base/interruption.h"
#include "traces/datasets/image_header.h"
#include "traces/datasets/jpeg_file.h"

namespace leviosim::traces {
namespace {

// Calls of libpng from C++. The library leaves a call at an error by a jump over all frames in
// between; here the jump ends in a plain result.

/// What libpng keeps of one file that is read or written.
class PngCalls {
 public:
  enum class Kind { Read, Write };

  /// @throws std::bad_alloc
  explicit PngCalls(Kind kind) : kind_(kind) {
    const auto create = kind == Kind::Read ? png_create_read_struct_2 : png_create_write_struct_2;
    png_ = create(PNG_LIBPNG_VER_STRING, this, fail, ignore, this, allocate, release);
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
    if (info_ == nullptr) {
      destroy();
      throw std::bad_alloc();
    }
  }
  ~PngCalls() { destroy(); }
  PngCalls(const PngCalls&) = delete;
  PngCalls& operator=(const PngCalls&) = delete;

  png_structp png() const { return png_; }
  png_infop info() const { return info_; }

  /// Whether `body` came to its end; std::bad_alloc if memory was lacking. An error of the library
  /// ends it where it is, so it must hold no object that has a destructor.
  template <class Body>
  bool succeed(const Body& body) {
    if (setjmp(png_jmpbuf(png_)) == 0) {
      body();
      return true;
    }
    if (out_of_memory_) throw std::bad_alloc();
    return false;
  }
  /// Of the last error.
  const std::string& reason() const { return reason_; }

 private:
  [[noreturn]] static void fail(png_structp png, png_const_charp message) {
    static_cast<PngCalls*>(png_get_error_ptr(png))->reason_ = message;
    png_longjmp(png, 1);
  }
  static void ignore(png_structp, png_const_charp) {}
  static void* allocate(png_structp png, png_alloc_size_t size) {
    void* const memory = std::malloc(size);
    if (memory == nullptr) static_cast<PngCalls*>(png_get_mem_ptr(png))->out_of_memory_ = true;
    return memory;
  }
  static void release(png_structp, void* memory) { std::free(memory); }
  void destroy() {
    if (kind_ == Kind::Read)
      png_destroy_read_struct(&png_, &info_, nullptr);
    else
      png_destroy_write_struct(&png_, &info_);
  }

  Kind kind_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  std::string reason_;
  bool out_of_memory_ = false;
};

constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n";
constexpr std::string_view kJpegSignature = "\xff\xd8\xff";
constexpr std::size_t kMostChunkBytes = std::size_t{1} << 24;  ///< of what is not pixels

void require_size(const ImageHeader& header, ImageSize expected) {
  if (header.width != static_cast<unsigned>(expected.width) ||
      header.height != static_cast<unsigned>(expected.height))
    throw InputError(fmt::format("is {}x{}; the camera's pictures are {}x{}", header.width,
                                 header.height, expected.width, expected.height));
}

class Png {
 public:
  explicit Png(std::string_view bytes) : calls_(PngCalls::Kind::Read), rest_(bytes) {
    demand([&] {
      png_set_read_fn(calls_.png(), &rest_, read);
      png_set_read_status_fn(calls_.png(), [](png_structp png, png_uint_32, int) { poll(png); });
      png_set_crc_action(calls_.png(), PNG_CRC_ERROR_QUIT, PNG_CRC_WARN_DISCARD);
      png_set_chunk_malloc_max(calls_.png(), kMostChunkBytes);
      // Texts, profiles and all else that no pixel needs is passed over, and never inflated.
      png_set_keep_unknown_chunks(calls_.png(), PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
      png_read_info(calls_.png(), calls_.info());
    });
  }

  ImageHeader header() {
    return {png_get_image_width(calls_.png(), calls_.info()),
            png_get_image_height(calls_.png(), calls_.info()),
            (png_get_color_type(calls_.png(), calls_.info()) & PNG_COLOR_MASK_COLOR) != 0};
  }

  /// To the end of the file.
  void decode(std::span<std::uint8_t> image) {
    const std::size_t count = header().height;
    const auto rows = std::make_unique<png_bytep[]>(count);
    for (std::size_t y = 0; y < count; ++y) rows[y] = image.data() + y * (image.size() / count);
    demand([&] {
      png_set_palette_to_rgb(calls_.png());
      png_set_expand_gray_1_2_4_to_8(calls_.png());
      png_set_strip_16(calls_.png());
      png_set_strip_alpha(calls_.png());
      png_set_interlace_handling(calls_.png());
      png_read_image(calls_.png(), rows.get());
      png_read_end(calls_.png(), nullptr);
    });
  }

 private:
  static void read(png_structp png, png_bytep to, std::size_t size) {
    auto& rest = *static_cast<std::string_view*>(png_get_io_ptr(png));
    // Asked as often as some kilobytes are read.
    constexpr std::size_t kBytesPerPoll = 1 << 14;
    const std::size_t left = rest.size() - std::min(size, rest.size());
    if (rest.size() / kBytesPerPoll != left / kBytesPerPoll) poll(png);
    if (size > rest.size()) png_error(png, "the file ends early");
    std::copy_n(rest.data(), size, to);
    rest.remove_prefix(size);
  }
  /// Becomes Interrupted in demand().
  static void poll(png_structp png) {
    if (pending_interrupt() != 0) png_error(png, "interrupted");
  }
  template <class Body>
  void demand(const Body& body) {
    if (calls_.succeed(body)) return;
    throw_if_interrupted();
    refuse_damaged_image("PNG", calls_.reason());
  }

  PngCalls calls_;
  std::string_view rest_;
};

template <class Format>
std::vector<std::uint8_t> decode_as(std::string_view bytes, ImageSize expected) {
  Format file(bytes);
  const ImageHeader header = file.header();
  require_size(header, expected);
  std::vector<std::uint8_t> image(expected.pixels() * (header.colour ? 3 : 1));
  file.decode(image);
  if (!header.colour) return image;
  std::vector<std::uint8_t> grey(expected.pixels());
  const cv::Mat coloured(expected.height, expected.width, CV_8UC3, image.data());
  cv::Mat result(expected.height, expected.width, CV_8UC1, grey.data());
  cv::cvtColor(coloured, result, cv::COLOR_RGB2GRAY);  // luma of Rec. 601, in fixed point
  return grey;
}

bool begins_with(std::string_view text, std::string_view start) {
  return text.substr(0, start.size()) == start;
}

/// What `use` makes of the file as its format.
template <class Use>
auto with_format(std::string_view bytes, const Use& use) {
  if (begins_with(bytes, kPngSignature)) return use.template operator()<Png>();
  if (begins_with(bytes, kJpegSignature)) return use.template operator()<JpegFile>();
  throw InputError("cannot be read as an image: it is neither PNG nor JPEG");
}

}  // namespace

std::vector<std::uint8_t> decode_gray(std::string_view bytes, ImageSize expected) {
  return with_format(bytes, [&]<class Format>() { return decode_as<Format>(bytes, expected); });
}

ImageSize image_size(std::string_view bytes) {
  const ImageHeader header =
      with_format(bytes, [&]<class Format>() { return Format(bytes).header(); });
  return {static_cast<int>(header.width), static_cast<int>(header.height)};
}

std::string encode_png(ImageSize size, std::span<const std::uint8_t> pixels) {
  check_equal(pixels.size(), size.pixels(), "encode_png");
  PngCalls calls(PngCalls::Kind::Write);
  std::string bytes;
  const bool written = calls.succeed([&] {
    const auto append = [](png_structp png, png_bytep from, std::size_t count) {
      static_cast<std::string*>(png_get_io_ptr(png))
          ->append(reinterpret_cast<const char*>(from), count);
    };
    png_set_write_fn(calls.png(), &bytes, append, nullptr);
    // Run-length coding suits noise: faster and smaller than the search for longer matches.
    png_set_compression_level(calls.png(), 1);
    png_set_compression_strategy(calls.png(), Z_RLE);
    png_set_IHDR(calls.png(), calls.info(), static_cast<png_uint_32>(size.width),
                 static_cast<png_uint_32>(size.height), 8, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(calls.png(), calls.info());
    for (std::size_t at = 0; at < pixels.size(); at += static_cast<std::size_t>(size.width))
      png_write_row(calls.png(), pixels.data() + at);
    png_write_end(calls.png(), nullptr);
  });
  check(written, calls.reason());
  return bytes;
}

}  // namespace leviosim::traces
