// Everything that a run produced, before it becomes tables and files. Plain data: simulate() fills
// it in, reporters read it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/units.h"
#include "sim/chip/config.h"
#include "sim/soc/camera.h"
#include "sim/soc/observer.h"
#include "sim/soc/run_account.h"
#include "sim/work/program.h"
#include "tools/app/table/banded.h"
#include "traces/trajectories/evaluation.h"
#include "traces/trajectories/trajectory.h"
#include "workload/vio/records.h"

namespace leviosim::tools {

using soc::CameraRecord;
using soc::Deadline;
using soc::StageResult;
using vio::PoseSource;

/// The result of a frame, and its times.
struct FrameResult : vio::FrameFacts, soc::FrameTiming {
  int index = 0;          ///< in the data set
  std::int64_t t_ns = 0;  ///< camera timestamp
  traces::StampedPose pose;
  /// Corrected poses of earlier frames, by how many frames ago they were processed.
  std::vector<std::pair<int, traces::StampedPose>> earlier = {};
  /// On N cores, over all calls, of RunResult::frame_stages; stages at the end are left out if they
  /// did not run.
  std::vector<Cycles> stage_cycles = {};
};

/// Names of the rows of L2 that do not come from the workload.
inline constexpr const char* kOptimiserL2 = "optimiser";
/// … and what the optimiser keeps in external memory.
inline constexpr const char* kOptimiserExternal = "optimiser outside";
inline constexpr const char* kCameraL2 = "camera";

/// One row of the L2 part of the memory table.
struct L2Row {
  std::string name;  ///< "last keyframe", "pose graph", "optimiser"
  Bytes bytes;
  std::vector<work::Block> blocks;
};

/// Bands of times, as ratios to their values, from the ranges of the platform's numbers.
struct TimeBands {
  struct Stage {
    std::string stage;
    Banded parallel{1, 1, 1};  ///< of a mean call on N cores
    Banded single{1, 1, 1};    ///< on one core, where that was asked for
  };
  Banded mean{1, 1, 1};     ///< of a mean frame
  Banded slowest{1, 1, 1};  ///< of the slowest frame, which stands for all slow ones
  std::vector<Stage> stages{};
};

/// What a run is of, known before it begins.
struct RunSubject {
  std::string profile;
  std::int64_t frame_period_ns = 0;  ///< of the camera
  int image_width = 0;               ///< [px]
  int image_height = 0;
};

struct RunResult : RunSubject {
  std::vector<std::string> notes{};  ///< on data that were mended, and on idle cores; a line each
  bool timed = true;                 ///< false for --native: no cycles, no latencies
  int cores = 8;
  Hertz cluster_clock;
  Hertz controller_clock;
  Bytes l1_size;
  Bytes l2_size;
  std::vector<StageResult> stages;          ///< in the order of the workload
  Cycles offload;                           ///< of the cluster's jobs, outside of stages
  std::vector<FrameResult> frames;          ///< frames that the front end processed
  std::vector<std::string> frame_stages{};  ///< names of FrameResult::stage_cycles
  std::optional<CameraRecord> camera;       ///< of a closed loop
  Bytes external_size;
  std::vector<L2Row> l2;
  std::vector<L2Row> external;  ///< what lies in external memory, since L2 has no room for it
  std::int64_t optimiser_published = 0;  ///< results that reached the front end
  std::int64_t optimiser_late = 0;       ///< frames at whose start the controller was still busy
  std::vector<traces::StampedPose> trajectory;
  int poses_left_out = 0;                 ///< of the trajectory, since they are NaN
  std::optional<traces::Evaluation> ate;  ///< where ground truth exists and all poses are numbers
  std::string
      not_comparable;  ///< why the trajectory could not be evaluated; see why_incomparable()
  std::optional<TimeBands> time_bands{};  ///< where they were asked for
  double host_seconds = 0;  ///< wall time; not part of anything that must be reproducible
  sim::ChipConfig chip{};   ///< chip that the run was timed on; unused if not timed
};

}  // namespace leviosim::tools
