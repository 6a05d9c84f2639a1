// The workload over a data set, computing as the simulation asks for its work.
#pragma once

#include <future>
#include <memory>
#include <vector>

#include "tools/app/run/feed.h"
#include "tools/app/run/run_request.h"
#include "tools/app/run/run_source.h"
#include "workload/vio/odometry/odometry.h"
#include "workload/vio/profile.h"

namespace leviosim::tools {

class LiveSource : public RunSource {
 public:
  /// @param request  outlives the source
  explicit LiveSource(const RunRequest& request);

  int frames() const override { return feed_.size(); }
  std::int64_t time_ns(int frame) const override { return feed_.time_ns(frame); }
  std::int64_t arrival_ns(int frame) const override { return feed_.arrival_ns(frame); }
  bool begin_frame(const soc::FrameStart& start) override;
  const work::Job& process(FrameResult& result) override;
  int iterations() const override { return profile_.optimiser_iterations; }
  int frames_that_wait() const override;
  const work::Job& optimise() override;
  void publish() override;
  std::vector<StageResult> empty_stages() const override;
  RunSubject subject() const override { return subject_of(profile_.name, feed_); }
  void describe(RunResult& result) const override;

 private:
  void evaluate(RunResult& result) const;
  std::vector<std::string> notes() const;

  vio::Profile profile_;
  bool evaluate_;
  FilmWriter* film_;
  Feed feed_;
  work::Machine cluster_;
  work::Machine controller_;
  std::unique_ptr<vio::Odometry> odometry_;
  int frame_ = 0;                           ///< begun last
  std::vector<std::int64_t> processed_ns_;  ///< stamps of the frames processed so far
  work::Job front_end_job_;
  work::Job optimiser_job_;
};

/// The machine of the request's cluster.
work::MachineConfig cluster_machine(const RunRequest& request, int alignment);
/// The same with so much L1.
work::MachineConfig cluster_machine(const RunRequest& request, int alignment, Bytes l1);

/// The machine of the request's controller, with so much L2, the camera's part among it.
work::MachineConfig controller_machine(const RunRequest& request, Bytes l2);

/// What the profile leaves its workload of the request's L1.
Bytes l1_of(const RunRequest& request, const vio::Profile& profile);

/// Stages that were not called yet.
std::vector<StageResult> named_stages(const std::vector<vio::StageName>& names);

}  // namespace leviosim::tools
