#include "traces/synthesis/flight_images.h"

#include <fmt/core.h>

#include <mutex>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/threads.h"
#include "traces/datasets/asl_writer.h"
#include "traces/datasets/image_file.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::traces {

void write_flight_images(outputs::OutputFolder& out, const std::vector<std::int64_t>& stamps_ns,
                         ImageSize size, const DrawImage& draw, unsigned threads,
                         const FlightProgress& progress) {
  std::mutex mutex;
  std::size_t done = 0;
  base::parallel_for(stamps_ns.size(), threads, [&](std::size_t i) {
    out.write("mav0/cam0/data/" + image_name(stamps_ns[i]), encode_png(size, draw(i)));
    const std::lock_guard<std::mutex> lock(mutex);
    ++done;
    if (progress) progress(done, stamps_ns.size());
  });
}

void commit_flight(outputs::OutputFolder& out) {
  if (const std::optional<std::string> elsewhere = out.commit()) throw InputError(*elsewhere);
}

}  // namespace leviosim::traces
