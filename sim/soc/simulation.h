// The loop of a run: camera, front end and optimiser as processes in simulated time, around a
// source of work that, if live, really computes.
//
//   camera ──frames──▶ front end (cluster) ──snapshot──▶ optimiser (fabric controller)
//                          ▲                                   │
//                          └────────── published result ───────┘
//
// By default the loop is open: every recorded frame is delivered and waits until the front end has
// time for it. Closed (RunRequest::camera), the camera has its own rate and two buffers (camera.h),
// and frames are lost.
//
// A stage's values are computed when it starts in simulated time and used by others when it ends:
// the front end of a frame sees what the optimiser had published when the frame was taken up.
#pragma once

#include "sim/chip/chip.h"
#include "sim/events/channel.h"
#include "sim/soc/job_source.h"
#include "sim/soc/job_timer.h"
#include "sim/soc/stage_book.h"
#include "tools/app/run/run_request.h"

namespace leviosim::tools {

class Simulation {
 public:
  /// @param request  the chip and its observer; it and the source outlive the simulation
  Simulation(const RunRequest& request, JobSource& source, ProgressCallback progress);

  /// Runs all frames of the source.
  RunResult run();

 private:
  sim::Process camera();
  sim::Process front_end();
  sim::Process optimiser();
  /// Whether a frame that has arrived is taken. In a closed loop it may be dropped.
  bool takes(int frame);
  std::int64_t now_ns() const;
  RunResult take_result();

  const RunRequest& request_;
  JobSource& source_;
  ProgressCallback progress_;
  sim::Chip chip_;
  JobTimer single_core_;  ///< the same jobs on one worker
  sim::Channel<int> camera_frames_;
  int in_hand_ = 0;  ///< frames taken whose pose is not out yet
  sim::Event snapshot_taken_;
  bool optimiser_busy_ = false;
  int snapshot_frame_ = 0;    ///< at whose start the optimiser's snapshot was taken
  int published_frame_ = -1;  ///< the same of the result that was published last
  StageBook book_;
  RunResult result_;
};

}  // namespace leviosim::tools
