// The optical flow over a data set, as work for a simulation: a second workload beside LEVIO
// (run/live_source.h), which the same chips, tables and figures serve. Frames come as recorded; no
// optimiser.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "sim/work/machine.h"
#include "tools/app/flow/binned_frames.h"
#include "tools/app/result/run_result.h"
#include "tools/app/run/run_request.h"
#include "tools/app/run/run_source.h"
#include "traces/datasets/dataset.h"
#include "workload/flow/estimator.h"

namespace leviosim::tools {

class FlowSource : public RunSource {
 public:
  /// @param request  data, frames, platform and cores are used
  /// @param options  the focal length is that of the data
  /// @throws InputError for data or options that cannot be used
  FlowSource(const RunRequest& request, flow::Options options);

  int frames() const override { return static_cast<int>(data_.frames.size()); }
  std::int64_t time_ns(int frame) const override {
    return data_.frames[static_cast<std::size_t>(frame)].t_ns;
  }
  bool begin_frame(const soc::FrameStart& start) override;
  const work::Job& process(FrameResult& result) override;
  int iterations() const override { return 0; }
  const work::Job& optimise() override;
  void publish() override {}
  std::vector<StageResult> empty_stages() const override;
  RunSubject subject() const override;
  void describe(RunResult& result) const override;

  /// Of the frames so far; the first has none.
  const std::vector<flow::Flow>& flows() const { return flows_; }
  const BinnedFrames& camera() const { return camera_; }
  /// Mean rate of rotation since the frame before, in the camera frame [rad/s].
  Eigen::Vector3d rate_before(int frame) const;
  const traces::Dataset& data() const { return data_; }

 private:
  traces::Dataset data_;
  BinnedFrames camera_;
  flow::Options options_;
  work::Machine cluster_;
  std::unique_ptr<flow::Estimator> estimator_;
  int frame_ = 0;  ///< begun last
  work::Job job_;
  std::vector<flow::Flow> flows_;
};

}  // namespace leviosim::tools
