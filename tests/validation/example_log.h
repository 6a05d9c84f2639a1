// A run as a frame log, made by hand: every kind of frame once or twice, with round numbers.
#pragma once

#include "sim/work/op.h"
#include "tests/tools/example_run.h"
#include "tools/app/validation/frame_log.h"
#include "workload/vio/stages.h"

namespace leviosim::tools::testing {

inline sim::StageTiming stage_timing(std::string_view stage, std::int64_t cycles) {
  sim::StageTiming timing{};
  timing.stage = stage;
  timing.cycles = Cycles(cycles);
  return timing;
}

/// A frame whose stages take `cycles` on eight cores and seven times as long on one.
struct ExampleFrame {
  PoseSource source = PoseSource::Epnp;
  bool keyframe = false;
  int features = 0;
  int landmarks = 0;  ///< alive afterwards
  std::vector<std::pair<std::string_view, std::int64_t>> stages;
};

inline void feed(FrameLog& log, const ExampleFrame& example) {
  FrameResult result;
  result.index = static_cast<int>(log.frames().size());
  result.source = example.source;
  result.keyframe = example.keyframe;
  result.features = example.features;
  result.frame_matches = 50;
  result.landmarks = example.landmarks;
  work::Job job;
  sim::JobTiming parallel;
  sim::JobTiming single;
  for (const auto& [stage, cycles] : example.stages) {
    work::StageRun run{stage, {}, {}};
    work::Counts counts;
    counts[work::Op::IntAlu] = static_cast<std::uint64_t>(cycles);
    run.steps.push_back(work::Serial{counts});
    job.stages.push_back(run);
    parallel.stages.push_back(stage_timing(stage, cycles));
    single.stages.push_back(stage_timing(stage, 7 * cycles));
    result.cycles += Cycles(cycles);
    result.single_cycles += Cycles(7 * cycles);
  }
  log.on_front_end({result.index, false, result, job, parallel, single});
}

/// The first frame, one with EPnP, one with EPnP that becomes a keyframe, one whose EPnP is
/// refused, one with the 8-point algorithm alone.
inline FrameLog example_log() {
  namespace s = vio::stages;
  FrameLog log;
  feed(log, {PoseSource::First, true, 100, 0, {{s::kExtraction, 9'000}, {s::kTriangulation, 10}}});
  feed(log, {PoseSource::EightPoint,
             true,
             200,
             80,
             {{s::kExtraction, 10'000},
              {s::kWorldMatching, 100},
              {s::kFrameMatching, 2'000},
              {s::kEightPoint, 40'000},
              {s::kTriangulation, 700}}});
  feed(log, {PoseSource::Epnp,
             false,
             300,
             80,
             {{s::kImu, 100},
              {s::kImu, 100},
              {s::kExtraction, 11'000},
              {s::kWorldMatching, 3'000},
              {s::kEpnp, 50'000},
              {s::kFrameMatching, 2'000}}});
  feed(log, {PoseSource::EightPoint,
             false,
             200,
             80,
             {{s::kExtraction, 10'000},
              {s::kWorldMatching, 5'000},
              {s::kEpnp, 30'000},
              {s::kFrameMatching, 2'000},
              {s::kEightPoint, 20'000}}});
  return log;
}

}  // namespace leviosim::tools::testing
