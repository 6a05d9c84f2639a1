// Whether a workload is feasible on a chip: how long its frames take, what they cost, and whether
// it fits. The work is computed once, recorded, and timed on every chip (run/trace_source.h), so
// all chips do the same work: what each frame and each optimisation of the recording did, whatever
// the chip's speed would have changed. For a chip with too little L1 or L2 it is computed once more
// in memories of its sizes: the same poses, from what passes in tiles or lies in external memory.
// Memories have room for everything while it is timed; what would not have fitted even so is part
// of the verdict.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/energy/estimate.h"
#include "tools/app/run/run_request.h"
#include "tools/app/study/runner.h"
#include "traces/work_traces/work_trace.h"

namespace leviosim::tools {

/// The peak of a memory.
struct MemoryVerdict {
  Bytes size;
  Bytes occupied;
  std::string block;  ///< the first that does not fit, in the order of allocation; empty if all do
  bool fits() const { return occupied <= size; }
};

/// A stage of the workload on a chip.
struct StageTime {
  std::string name;
  double kilocycles = 0;  ///< of a call, mean
};

struct Feasibility {
  std::string platform;  ///< as asked for
  std::string failure;   ///< why the work cannot be timed there; then there are no figures
  int cores = 0;
  Hertz clock;  ///< of the cluster
  MemoryVerdict l1;
  MemoryVerdict l2;
  bool in_tiles = false;    ///< blocks pass through L1
  Bytes external;           ///< that lie in external memory
  double front_end_ms = 0;  ///< of a frame, mean; on a chip that has nothing else to do
  double worst_ms = 0;
  double optimiser_ms = 0;        ///< per frame
  std::vector<StageTime> stages;  ///< that were called
  bool shares_core = false;       ///< front end and optimiser take turns
  /// At the rate at which the chip keeps up, or at that of the camera if that is lower; absent if
  /// the platform has no energy figures.
  std::optional<sim::Estimate<Joules>> energy_per_frame;
  std::optional<sim::Estimate<Watts>> power;

  bool fits() const { return failure.empty() && l1.fits() && l2.fits(); }
  /// That the chip needs for a frame in the long run: two processors work at the same time.
  double frame_ms() const;
  double frames_per_second() const { return 1e3 / frame_ms(); }
};

/// A chip with so many of its cores.
struct FeasibilityPoint {
  std::string name;  ///< as asked for
  platform::ResolvedPlatform platform;
  int cores = 0;
  std::string failure = {};  ///< why there is no such chip
};

/// Work of one workload over one flight, computed when it is first asked for and then kept, for
/// each number of cores that it is divided among and for memories that are too small for it.
class FeasibilityStudy {
 public:
  /// @param request  what to compute; its platform and cores are not used
  FeasibilityStudy(RunRequest request, ProgressCallback progress)
      : request_(std::move(request)), progress_(std::move(progress)) {
    request_.pictures = std::make_shared<traces::PictureMemory>();
  }

  /// @throws InputError for more cores than the platform serves
  Feasibility on(const FeasibilityPoint& point);
  /// A row a point; of one that fails, its reason. @throws InputError if all fail
  std::vector<Feasibility> on(const std::vector<FeasibilityPoint>& points,
                              const RunnerOptions& options);

 private:
  /// Work as it was recorded.
  struct Recorded {
    std::unique_ptr<traces::WorkTrace> trace;
    Bytes l1, l2;           ///< peaks
    bool in_tiles = false;  ///< blocks pass through L1
  };
  /// Of the chip on which it is recorded; none of a size that the recording chip has anyway.
  struct Memories {
    int cores;
    std::optional<Bytes> l1, l2, external;
    auto operator<=>(const Memories&) const = default;
  };

  const Recorded& work_on(const FeasibilityPoint& point);
  const Recorded& work_in(const Memories& memories);

  RunRequest request_;
  ProgressCallback progress_;
  std::map<Memories, Recorded> work_;
};

}  // namespace leviosim::tools
