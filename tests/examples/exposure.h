// The example of workload/EXTENDING.md: a kernel, a stage, and a workload of that one stage, the
// mean grey level of each frame. The page shows what stands between the marks.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/work/machine.h"
#include "tools/app/run/run_source.h"

namespace leviosim::example {

// [kernel]
/// Sum of the grey levels of a row.
template <class P>
typename P::I32 row_sum(typename P::template Span<const typename P::Byte> row) {
  using I = typename P::I32;
  I sum = 0;
  for (int x : P::range(0, row.size())) sum += I(row[x]);
  return sum;
}
// [/kernel]

// [stage]
/// Mean grey level of an image of width × height pixels in L2.
template <class P>
int mean_level(work::Machine& machine, const std::uint8_t* pixels, int width, int height) {
  using I = typename P::I32;
  using Byte = typename P::Byte;
  const auto stage = machine.stage("exposure");
  work::Arena& memory = machine.local();
  const work::Arena::Frame frame(memory);  // what is allocated from now on is freed at the end
  const auto image = memory.alloc<typename P::template Span<Byte>>("image", width * height);
  const auto sums = memory.alloc<typename P::template Span<I>>("sums", machine.cores());

  const auto* bytes = reinterpret_cast<const Byte*>(pixels);
  machine.copy_in(image, typename P::template L2Span<const Byte>(bytes, width * height));
  machine.fork("rows", [&](work::Core& core) {
    const auto [begin, end] = core.share(height);
    I sum = 0;
    for (int y : P::range(begin, end)) sum += row_sum<P>(image.subspan(y * width, width));
    sums[core.id] = sum;
  });
  I total = 0;
  for (int id : P::range(0, machine.cores())) total += I(sums[id]);
  return work::value(I(total / I(width * height)));
}
// [/stage]

struct Frames {
  int width = 0;
  int height = 0;
  std::int64_t period_ns = 0;
  std::vector<std::vector<std::uint8_t>> images;
};

// [source]
/// Computes as the simulation asks for work.
class ExposureSource : public tools::RunSource {
 public:
  ExposureSource(const Frames& frames, const sim::ChipConfig& chip, int cores)
      : frames_(frames),
        machine_({.cores = cores, .capacity = chip.cluster.l1.size, .record = true}) {}

  int frames() const override { return static_cast<int>(frames_.images.size()); }
  std::int64_t time_ns(int frame) const override { return frame * frames_.period_ns; }
  bool begin_frame(const soc::FrameStart& start) override {
    frame_ = start.frame;
    return false;  // no optimisation on the controller
  }
  const work::Job& process(tools::FrameResult& result) override {
    const auto& pixels = frames_.images[static_cast<std::size_t>(frame_)];
    levels.push_back(
        mean_level<work::Counting>(machine_, pixels.data(), frames_.width, frames_.height));
    result.index = frame_;
    result.t_ns = time_ns(frame_);
    job_ = machine_.take_job();
    return job_;
  }
  int iterations() const override { return 0; }
  const work::Job& optimise() override { return job_; }
  void publish() override {}
  std::vector<tools::StageResult> empty_stages() const override { return {}; }
  void describe(tools::RunResult& result) const override {
    result.profile = "exposure";
    result.frame_period_ns = frames_.period_ns;
  }

  std::vector<int> levels;  ///< of the frames so far

 private:
  const Frames& frames_;
  work::Machine machine_;
  int frame_ = 0;
  work::Job job_;
};
// [/source]

}  // namespace leviosim::example
