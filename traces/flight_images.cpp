#include "traces/flight_images.h"

#include <fmt/core.h>

#include <mutex>
#include <opencv2/imgcodecs.hpp>

#include "sim/check.h"
#include "sim/error.h"
#include "traces/asl_writer.h"
#include "traces/parallel_for.h"

namespace leviosim::traces {
namespace {

namespace fs = std::filesystem;

void write_png(const fs::path& file, ImageSize size, std::vector<std::uint8_t>& pixels) {
  check_equal(pixels.size(), static_cast<std::size_t>(size.width) * size.height, "write_png");
  const cv::Mat image(size.height, size.width, CV_8UC1, pixels.data());
  // Run-length coding suits noise: faster and smaller than the search for longer matches.
  const std::vector<int> fast{cv::IMWRITE_PNG_COMPRESSION, 1, cv::IMWRITE_PNG_STRATEGY,
                              cv::IMWRITE_PNG_STRATEGY_RLE};
  if (!cv::imwrite(file.string(), image, fast))
    throw InputError(fmt::format("{}: cannot be written", file.string()));
}

}  // namespace

void check_flight_folder(const fs::path& out_dir, bool overwrite) {
  if (!fs::exists(out_dir)) return;
  if (!overwrite)
    throw InputError(fmt::format("{}: already exists; choose another folder or allow overwriting",
                                 out_dir.string()));
  if (!fs::is_directory(out_dir / "mav0") && !(fs::is_directory(out_dir) && fs::is_empty(out_dir)))
    throw InputError(fmt::format("{}: is not overwritten because it is no ASL folder (no mav0)",
                                 out_dir.string()));
}

void write_flight_images(const fs::path& folder, const std::vector<std::int64_t>& stamps_ns,
                         ImageSize size, const DrawImage& draw, unsigned threads,
                         const FlightProgress& progress) {
  std::mutex mutex;
  std::size_t done = 0;
  parallel_for(stamps_ns.size(), threads, [&](std::size_t i) {
    std::vector<std::uint8_t> pixels = draw(i);
    write_png(folder / image_name(stamps_ns[i]), size, pixels);
    const std::lock_guard<std::mutex> lock(mutex);
    ++done;
    if (progress) progress(done, stamps_ns.size());
  });
}

}  // namespace leviosim::traces
