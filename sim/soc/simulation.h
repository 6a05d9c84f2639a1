// The loop of a run: camera, front end and optimiser as processes in simulated time, around a
// source of work that, if live, really computes. It knows frames and jobs, not what they are for.
//
//   camera ──frames──▶ front end (cluster) ──snapshot──▶ optimiser (fabric controller)
//                          ▲                                   │
//                          └────────── published result ───────┘
//
// By default the loop is open: every frame is delivered and waits until the front end has time for
// it. Closed (Setup::deadline), the camera has two buffers (camera.h), and frames are lost.
//
// A stage's values are computed when it starts in simulated time and used by others when it ends:
// the front end of a frame sees what the optimiser had published when the frame began.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "sim/chip/chip.h"
#include "sim/events/channel.h"
#include "sim/soc/camera.h"
#include "sim/soc/job_source.h"
#include "sim/soc/job_timer.h"
#include "sim/soc/observer.h"
#include "sim/soc/run_account.h"

namespace leviosim::soc {

/// Called after every frame.
struct Progress {
  int done = 0;
  int total = 0;
  std::int64_t simulated_ns = 0;
};
using ProgressCallback = std::function<void(const Progress&)>;

struct Setup {
  const sim::ChipConfig& chip;
  int cores = 1;                     ///< of the cluster
  std::optional<Deadline> deadline;  ///< of a closed loop
  bool on_one_core = true;           ///< whether jobs are also timed on the master alone
};

struct Outcome {
  std::vector<StageResult> stages;
  Cycles offload;                        ///< of the cluster's jobs, outside of stages
  std::optional<CameraRecord> camera;    ///< of a closed loop; its rate is not filled in
  std::int64_t optimiser_published = 0;  ///< results that reached the front end
  std::int64_t optimiser_late = 0;       ///< frames at whose start the controller was still busy
};

class Simulation {
 public:
  /// What setup refers to, source and observer outlive the simulation.
  /// @throws InputError for a flight that is too long for the chip's timebase
  Simulation(const Setup& setup, JobSource& source, Observer& observer, ProgressCallback progress);

  /// Runs all frames of the source.
  Outcome run();

 private:
  sim::Process camera();
  sim::Process front_end();
  sim::Process optimiser();
  /// Whether a frame that has arrived is taken. In a closed loop it may be dropped.
  bool takes(int frame);
  std::int64_t now_ns() const;

  JobSource& source_;
  Observer& observer_;
  ProgressCallback progress_;
  sim::Chip chip_;
  bool on_one_core_;
  JobTimer single_core_;  ///< the same jobs on the master alone
  sim::Channel<int> camera_frames_;
  int in_flight_ = 0;  ///< frames taken whose result is not out yet
  sim::Event snapshot_taken_;
  bool optimiser_busy_ = false;
  int snapshot_frame_ = 0;    ///< at whose start the optimiser's snapshot was taken
  int published_frame_ = -1;  ///< the snapshot frame of the result that was published last
  RunAccount account_;
  Outcome outcome_;
};

}  // namespace leviosim::soc
