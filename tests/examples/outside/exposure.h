// The example of workload/EXTENDING.md: a stage, and a workload of that one stage, the mean grey
// level of each frame. The page shows what stands between the marks.
#pragma once

#include <cstdint>

#include "exposure_code.h"
#include "exposure_kernel.h"
#include "sim/work/machine.h"
#include "tools/app/run/workload.h"

namespace exposure {

using namespace leviosim;

// [stage]
/// Mean grey level of an image of width × height pixels in L2, of every `step`th row.
template <class P>
int mean_level(work::Machine& machine, const std::uint8_t* pixels, int width, int height,
               int step = 1) {
  using I = typename P::I32;
  using Byte = typename P::Byte;
  const auto stage = machine.stage("exposure");
  work::Arena& memory = machine.local();
  const work::Arena::Frame frame(memory);  // what is allocated from now on is freed at the end
  const auto image = memory.alloc<typename P::template Span<Byte>>("image", width * height);
  const auto sums = memory.alloc<typename P::template Span<I>>("sums", machine.cores());

  const auto* bytes = reinterpret_cast<const Byte*>(pixels);
  machine.copy_in(image, typename P::template L2Span<const Byte>(bytes, width * height));
  const int rows = height / step;
  machine.fork("rows", [&](work::Core& core) {
    const auto [begin, end] = core.share(rows);
    I sum = 0;
    for (int y : P::range(begin, end)) sum += row_sum<P>(image.subspan(y * step * width, width));
    sums[core.id] = sum;
  });
  I total = 0;
  for (int id : P::range(0, machine.cores())) total += I(sums[id]);
  return work::value(I(total / I(width * rows)));
}
// [/stage]

// [workload]
inline Workload workload() {
  Workload exposure;
  exposure.name = "exposure";
  exposure.description = "mean grey level of each frame";
  exposure.stages = {"exposure"};
  exposure.parameters = {vio::other_parameter("workload.row_step", vio::Parameter::Kind::whole,
                                              "rows", 1, 8, 1,
                                              "distance from one sampled row to the next")};
  exposure.code = exposure_code();
  exposure.begin = [](const tools::RunRequest& request) {
    const int step = static_cast<int>(tools::value_of(request, "workload.row_step"));
    return [step](work::Machine& machine, const vio::FrameInput& frame, tools::FrameResult&) {
      mean_level<work::Counting>(machine, frame.pixels, frame.width, frame.height, step);
    };
  };
  return exposure;
}
// [/workload]

}  // namespace exposure
