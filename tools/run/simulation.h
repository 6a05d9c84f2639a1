// The closed loop: camera, front end and optimiser as processes in simulated time, around a
// workload that really computes.
//
//   camera ──frames──▶ front end (cluster) ──snapshot──▶ optimiser (fabric controller)
//                          ▲                                   │
//                          └────────── published result ───────┘
//
// A stage's values are computed when it starts in simulated time and used by others when it ends:
// the front end of a frame sees what the optimiser had published when the frame was taken up.
#pragma once

#include "sim/chip/chip.h"
#include "sim/kernel/channel.h"
#include "tools/run/feed.h"
#include "tools/run/job_timer.h"
#include "tools/run/stage_book.h"

namespace leviosim::tools {

class Simulation {
 public:
  Simulation(const RunRequest& request, Feed& feed, ProgressCallback progress);

  /// Runs all frames of the feed.
  RunResult run();

 private:
  sim::Process camera();
  sim::Process front_end();
  sim::Process optimiser();
  std::int64_t now_ns() const;
  RunResult take_result();

  const RunRequest& request_;
  Feed& feed_;
  ProgressCallback progress_;
  sim::Chip chip_;
  JobTimer single_core_;  ///< the same jobs on one worker
  work::Machine cluster_;
  work::Machine controller_;
  std::unique_ptr<vio::Odometry> odometry_;
  sim::Channel<int> camera_frames_;
  sim::Event snapshot_taken_;
  bool optimiser_busy_ = false;
  int snapshot_frame_ = 0;  ///< at whose start the optimiser's snapshot was taken
  StageBook book_;
  RunResult result_;
};

}  // namespace leviosim::tools
