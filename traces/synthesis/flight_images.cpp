#include "traces/synthesis/flight_images.h"

#include <mutex>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "sim/base/parallel_for.h"
#include "traces/datasets/asl_writer.h"
#include "traces/datasets/image_file.h"

namespace leviosim::traces {
namespace {

std::string png(ImageSize size, std::vector<std::uint8_t>& pixels) {
  check_equal(pixels.size(), static_cast<std::size_t>(size.width) * size.height, "png");
  return encode_png(cv::Mat(size.height, size.width, CV_8UC1, pixels.data()));
}

}  // namespace

void write_flight_images(outputs::OutputFolder& out, const std::vector<std::int64_t>& stamps_ns,
                         ImageSize size, const DrawImage& draw, unsigned threads,
                         const FlightProgress& progress) {
  std::mutex mutex;
  std::size_t done = 0;
  base::parallel_for(stamps_ns.size(), threads, [&](std::size_t i) {
    std::vector<std::uint8_t> pixels = draw(i);
    out.write("mav0/cam0/data/" + image_name(stamps_ns[i]), png(size, pixels));
    const std::lock_guard<std::mutex> lock(mutex);
    ++done;
    if (progress) progress(done, stamps_ns.size());
  });
}

void commit_flight(outputs::OutputFolder& out) {
  if (const std::optional<std::string> elsewhere = out.commit()) throw InputError(*elsewhere);
}

}  // namespace leviosim::traces
