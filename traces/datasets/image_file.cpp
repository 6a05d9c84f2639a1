#include "traces/datasets/image_file.h"

#include <fmt/core.h>
#include <spng.h>
#include <turbojpeg.h>
#include <zlib.h>

#include <cstdlib>
#include <memory>

#include "sim/base/check.h"
#include "sim/base/error.h"

namespace leviosim::traces {
namespace {

constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n";
constexpr std::string_view kJpegSignature = "\xff\xd8\xff";
constexpr std::size_t kMostChunkBytes = std::size_t{1} << 24;  ///< of what is not pixels

/// What the head of a file says.
struct Header {
  unsigned width = 0, height = 0;
  int channels = 0;
  int bits = 0;  ///< of a channel, as decoded
};

[[noreturn]] void refuse_damaged(const char* format, const char* reason) {
  throw InputError(fmt::format("cannot be read as an image: damaged {}: {}", format, reason));
}

void require_gray(const Header& header, cv::Size expected) {
  if (header.channels != 1 || header.bits != 8)
    throw InputError(fmt::format("has {} channel{} of {} bits; expected 8-bit grey (1 channel)",
                                 header.channels, header.channels == 1 ? "" : "s", header.bits));
  if (header.width != static_cast<unsigned>(expected.width) ||
      header.height != static_cast<unsigned>(expected.height))
    throw InputError(fmt::format("is {}x{}; sensor.yaml says {}x{}", header.width, header.height,
                                 expected.width, expected.height));
}

class Png {
 public:
  explicit Png(std::string_view bytes) : context_(spng_ctx_new(0), spng_ctx_free) {
    if (context_ == nullptr) throw std::bad_alloc();
    demand(spng_set_crc_action(context_.get(), SPNG_CRC_ERROR, SPNG_CRC_DISCARD));
    demand(spng_set_chunk_limits(context_.get(), kMostChunkBytes, kMostChunkBytes));
    demand(spng_set_png_buffer(context_.get(), bytes.data(), bytes.size()));
  }

  Header header() {
    spng_ihdr head{};
    demand(spng_get_ihdr(context_.get(), &head));
    const int bits = head.bit_depth == 16 ? 16 : 8;
    return {head.width, head.height, channels_of(head.color_type), bits};
  }

  void decode(cv::Mat& image) {
    demand(spng_decode_image(context_.get(), image.data, image.total(), SPNG_FMT_G8, 0));
    demand(spng_decode_chunks(context_.get()));  // to the end of the file
  }

 private:
  static int channels_of(int color_type) {
    switch (color_type) {
      case SPNG_COLOR_TYPE_GRAYSCALE:
        return 1;
      case SPNG_COLOR_TYPE_GRAYSCALE_ALPHA:
        return 2;
      case SPNG_COLOR_TYPE_TRUECOLOR_ALPHA:
        return 4;
      default:
        return 3;
    }
  }
  static void demand(int status) {
    if (status != 0) refuse_damaged("PNG", spng_strerror(status));
  }

  std::unique_ptr<spng_ctx, void (*)(spng_ctx*)> context_;
};

class Jpeg {
 public:
  explicit Jpeg(std::string_view bytes)
      : bytes_(reinterpret_cast<const unsigned char*>(bytes.data())),
        size_(bytes.size()),
        decoder_(tjInitDecompress(), tjDestroy) {
    if (decoder_ == nullptr) throw std::bad_alloc();
  }

  Header header() {
    int width = 0;
    int height = 0;
    int sampling = 0;
    int colours = 0;
    demand(
        tjDecompressHeader3(decoder_.get(), bytes_, size_, &width, &height, &sampling, &colours));
    if (width < 1 || height < 1) refuse_damaged("JPEG", "the file says no size");
    const int channels = colours == TJCS_GRAY                           ? 1
                         : colours == TJCS_CMYK || colours == TJCS_YCCK ? 4
                                                                        : 3;
    return {static_cast<unsigned>(width), static_cast<unsigned>(height), channels, 8};
  }

  void decode(cv::Mat& image) {
    constexpr int kFlags = TJFLAG_ACCURATEDCT | TJFLAG_STOPONWARNING | TJFLAG_LIMITSCANS;
    demand(tjDecompress2(decoder_.get(), bytes_, size_, image.data, image.cols,
                         static_cast<int>(image.step), image.rows, TJPF_GRAY, kFlags));
  }

 private:
  void demand(int status) {
    if (status != 0) refuse_damaged("JPEG", tjGetErrorStr2(decoder_.get()));
  }

  const unsigned char* bytes_;
  unsigned long size_;
  std::unique_ptr<void, int (*)(tjhandle)> decoder_;
};

template <class Format>
cv::Mat decode_as(std::string_view bytes, cv::Size expected) {
  Format file(bytes);
  require_gray(file.header(), expected);
  cv::Mat image(expected, CV_8UC1);
  file.decode(image);
  return image;
}

bool begins_with(std::string_view text, std::string_view start) {
  return text.substr(0, start.size()) == start;
}

}  // namespace

cv::Mat decode_gray(std::string_view bytes, cv::Size expected) {
  if (begins_with(bytes, kPngSignature)) return decode_as<Png>(bytes, expected);
  if (begins_with(bytes, kJpegSignature)) return decode_as<Jpeg>(bytes, expected);
  throw InputError("cannot be read as an image: it is neither PNG nor JPEG");
}

std::string encode_png(const cv::Mat& image) {
  check_equal(image.type(), CV_8UC1, "encode_png");
  check(image.isContinuous(), "rows of an image to encode follow each other");
  const std::unique_ptr<spng_ctx, void (*)(spng_ctx*)> context(spng_ctx_new(SPNG_CTX_ENCODER),
                                                               spng_ctx_free);
  if (context == nullptr) throw std::bad_alloc();
  const auto demand = [](int status) { check_equal(status, 0, spng_strerror(status)); };
  demand(spng_set_option(context.get(), SPNG_ENCODE_TO_BUFFER, 1));
  // Run-length coding suits noise: faster and smaller than the search for longer matches.
  demand(spng_set_option(context.get(), SPNG_IMG_COMPRESSION_LEVEL, 1));
  demand(spng_set_option(context.get(), SPNG_IMG_COMPRESSION_STRATEGY, Z_RLE));
  spng_ihdr header{};
  header.width = static_cast<std::uint32_t>(image.cols);
  header.height = static_cast<std::uint32_t>(image.rows);
  header.bit_depth = 8;
  header.color_type = SPNG_COLOR_TYPE_GRAYSCALE;
  demand(spng_set_ihdr(context.get(), &header));
  demand(spng_encode_image(context.get(), image.data, image.total(), SPNG_FMT_PNG,
                           SPNG_ENCODE_FINALIZE));
  std::size_t size = 0;
  int status = 0;
  const std::unique_ptr<void, void (*)(void*)> bytes(
      spng_get_png_buffer(context.get(), &size, &status), std::free);
  demand(status);
  return {static_cast<const char*>(bytes.get()), size};
}

}  // namespace leviosim::traces
