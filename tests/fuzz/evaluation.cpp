// Trajectories in all formats, and their comparison: an estimate, kBetweenParts, the truth, and if
// there is a third part, times of KITTI poses.
#include "traces/trajectories/evaluation.h"
#include "traces/trajectories/trajectory_alignment.h"

#include "tests/fuzz/fuzz_target.h"
#include "traces/trajectories/trajectory_errors.h"
#include "traces/trajectories/trajectory_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace leviosim;
  static fuzz::MemoryFile files[] = {fuzz::MemoryFile("-estimate"), fuzz::MemoryFile("-truth"),
                                     fuzz::MemoryFile("-times")};
  std::vector<std::string> parts = fuzz::parts_of(fuzz::text_of(data, size));
  if (parts.size() < 2) return 0;
  return fuzz::only_input_errors([&] {
    traces::ReadOptions options;
    if (parts.size() > 2) options.times = files[2].holding(parts[2]);
    const traces::TrajectoryPair pair =
        traces::read_pair(files[0].holding(parts[0]), files[1].holding(parts[1]), options);
    for (const auto alignment : {traces::Alignment::se3, traces::Alignment::sim3}) {
      const traces::Evaluation evaluation =
          evaluate(pair.estimate.poses, pair.truth.poses,
                   {.alignment = alignment, .stamps = pair.estimate.stamps});
      traces::relative_errors(evaluation, 1);
    }
  });
}
