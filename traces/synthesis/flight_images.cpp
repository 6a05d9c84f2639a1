#include "traces/synthesis/flight_images.h"

#include <mutex>
#include <opencv2/imgcodecs.hpp>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "sim/base/parallel_for.h"
#include "traces/datasets/asl_writer.h"

namespace leviosim::traces {
namespace {

std::vector<std::uint8_t> png(ImageSize size, std::vector<std::uint8_t>& pixels) {
  check_equal(pixels.size(), static_cast<std::size_t>(size.width) * size.height, "png");
  const cv::Mat image(size.height, size.width, CV_8UC1, pixels.data());
  // Run-length coding suits noise: faster and smaller than the search for longer matches.
  const std::vector<int> fast{cv::IMWRITE_PNG_COMPRESSION, 1, cv::IMWRITE_PNG_STRATEGY,
                              cv::IMWRITE_PNG_STRATEGY_RLE};
  std::vector<std::uint8_t> bytes;
  check(cv::imencode(".png", image, bytes, fast), "an image is encoded");
  return bytes;
}

}  // namespace

void write_flight_images(base::OutputFolder& out, const std::vector<std::int64_t>& stamps_ns,
                         ImageSize size, const DrawImage& draw, unsigned threads,
                         const FlightProgress& progress) {
  std::mutex mutex;
  std::size_t done = 0;
  base::parallel_for(stamps_ns.size(), threads, [&](std::size_t i) {
    std::vector<std::uint8_t> pixels = draw(i);
    const std::vector<std::uint8_t> bytes = png(size, pixels);
    out.write("mav0/cam0/data/" + image_name(stamps_ns[i]),
              {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    const std::lock_guard<std::mutex> lock(mutex);
    ++done;
    if (progress) progress(done, stamps_ns.size());
  });
}

void commit_flight(base::OutputFolder& out) {
  if (const std::optional<std::string> elsewhere = out.commit()) throw InputError(*elsewhere);
}

}  // namespace leviosim::traces
