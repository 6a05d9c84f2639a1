#include "tests/fuzz/trace_reading.h"

#include <optional>

#include "platform_models/loader/loader.h"
#include "sim/chip/chip.h"
#include "sim/events/process.h"
#include "traces/work_traces/work_frames.h"

namespace leviosim::fuzz {
namespace {

constexpr Bytes kFuzzedTraceMemory{8 << 20};

sim::Process offload(sim::Chip& chip, const work::Job& job) { co_await chip.offload(job); }
sim::Process control(sim::Chip& chip, const work::Job& job) { co_await chip.control(job); }

/// Everything that a replay does with the work of a frame.
void time_on(sim::Chip& chip, const traces::WorkFrame& frame) {
  chip.kernel().spawn("front end", offload(chip, frame.front_end));
  chip.kernel().run();
  for (const work::Job& job : frame.iterations) {
    chip.kernel().spawn("optimiser", control(chip, job));
    chip.kernel().run();
  }
}

/// The tables of instruction caches take longer to make than an input to read.
sim::ChipConfig chip_without_caches() {
  sim::ChipConfig config = platform::load_platform("gap9-eigen");
  config.cluster.icache.line = config.controller.icache.line = Bytes(0);
  return config;
}

}  // namespace

void read_and_time(std::string bytes, int timed_frames) {
  static const sim::ChipConfig config = chip_without_caches();
  const traces::WorkTrace trace("fuzzed.trace", std::move(bytes), kFuzzedTraceMemory);
  const int cores = trace.info().cores;
  std::optional<sim::Chip> chip;
  traces::WorkFrames reader(trace, true);
  int frames = 0;
  for (traces::WorkFrame frame; reader.next(frame); ++frames) {
    if (cores > config.cluster.max_workers || frames >= timed_frames) continue;
    if (!chip) chip.emplace(config, cores);
    time_on(*chip, frame);
  }
}

}  // namespace leviosim::fuzz
