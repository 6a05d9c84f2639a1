// A source of work of constant length, on a chip with round numbers: what a closed loop does with
// it can be said in formulas.
#pragma once

#include <vector>

#include "sim/work/op.h"
#include "tests/sim/chip_test_config.h"
#include "tools/app/run/run_source.h"
#include "tools/app/run/simulate.h"

namespace leviosim::tools::testing {

/// Cycles of the master and of an iteration of the optimiser, besides what offloading takes.
struct ConstantWork {
  int frames = 100;
  std::int64_t period_ns = 1'000'000;
  std::uint64_t front_end = 10'000;
  std::uint64_t iteration = 0;  ///< 0: there is never anything to optimise
};

class ConstantSource : public RunSource {
 public:
  explicit ConstantSource(const ConstantWork& work) : work_(work) {
    front_end_ = job("front end", work.front_end);
    iteration_ = job("optimiser", work.iteration);
  }
  int frames() const override { return work_.frames; }
  std::int64_t time_ns(int frame) const override { return 7'000 + frame * work_.period_ns; }
  bool begin_frame(const soc::FrameStart& start) override {
    starts.push_back(start);
    return work_.iteration > 0 && !start.optimiser_busy;
  }
  const work::Job& process(FrameResult& result) override {
    result.index = starts.back().frame;
    return front_end_;
  }
  int iterations() const override { return 3; }
  const work::Job& optimise() override { return iteration_; }
  void publish() override {}
  std::vector<StageResult> empty_stages() const override { return {}; }
  RunSubject subject() const override {
    return {.profile = {}, .frame_period_ns = work_.period_ns};
  }
  void describe(RunResult&) const override {}

  std::vector<soc::FrameStart> starts;

 private:
  static work::Job job(std::string_view name, std::uint64_t cycles) {
    work::Serial serial;
    serial.counts[work::Op::IntAlu] = cycles;
    return {{{name, {serial}, {}}}};
  }

  ConstantWork work_;
  work::Job front_end_;
  work::Job iteration_;
};

/// Both clocks at `clock`; 100 MHz has cycles of 10 ns.
inline RunRequest request_at(Hertz clock, std::optional<Deadline> deadline) {
  RunRequest request;
  request.platform.config = sim::test_chip();
  request.platform.config.cluster.clock = clock;
  request.platform.config.controller.clock = clock;
  if (deadline) request.camera = CameraRequest{{}, *deadline};
  return request;
}

struct LoopRun {
  RunResult result;
  std::vector<soc::FrameStart> starts;
};

inline LoopRun run_loop(const ConstantWork& work, std::optional<Deadline> deadline,
                        Hertz clock = Hertz(100'000'000)) {
  ConstantSource source(work);
  const RunRequest request = request_at(clock, deadline);
  RunResult result = simulate_source(request, source, [](const Progress&) {});
  return {std::move(result), source.starts};
}

/// From the start of a frame until its pose is out.
inline std::int64_t length_ns(const ConstantWork& work, Hertz clock = Hertz(100'000'000)) {
  ConstantWork one = work;
  one.frames = 1;
  return run_loop(one, {}, clock).result.frames.at(0).end_ns;
}

}  // namespace leviosim::tools::testing
