// Reads a work trace to its end and runs some of its work on GAP9 with accelerators.
#pragma once

#include "platform_models/loader.h"
#include "sim/chip/chip.h"
#include "sim/kernel/process.h"
#include "traces/work_frames.h"

namespace leviosim::fuzz {

/// So that small inputs meet it.
inline constexpr Bytes kFuzzedTraceMemory{8 << 20};

inline sim::Process offload(sim::Chip& chip, const work::Job& job) { co_await chip.offload(job); }
inline sim::Process control(sim::Chip& chip, const work::Job& job) { co_await chip.control(job); }

/// Everything that a replay does with the work of a frame.
inline void time_on(sim::Chip& chip, const traces::WorkFrame& frame) {
  chip.kernel().spawn("front end", offload(chip, frame.front_end));
  chip.kernel().run();
  for (const work::Job& job : frame.iterations) {
    chip.kernel().spawn("optimiser", control(chip, job));
    chip.kernel().run();
  }
}

inline void read_and_time(std::string bytes, int timed_frames) {
  static const sim::ChipConfig config = platform::load_platform("gap9-eigen");
  const traces::WorkTrace trace("fuzzed.trace", std::move(bytes), kFuzzedTraceMemory);
  const int cores = trace.info().cores;
  const bool fits = cores <= config.cluster.max_workers;
  sim::Chip chip(config, fits ? cores : 1);
  traces::WorkFrames reader(trace, trace.has_kernels());
  int frames = 0;
  for (traces::WorkFrame frame; reader.next(frame); ++frames)
    if (fits && frames < timed_frames) time_on(chip, frame);
}

}  // namespace leviosim::fuzz
