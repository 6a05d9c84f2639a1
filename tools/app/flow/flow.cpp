#include "tools/app/flow/flow.h"

#include <fmt/core.h>

#include <cmath>

#include "platform_models/loader/compiled_code.h"
#include "sim/base/check.h"
#include "tools/app/result/summary.h"
#include "traces/datasets/dataset.h"
#include "traces/datasets/imu_samples.h"
#include "traces/recordings/recording.h"

namespace leviosim::tools {
namespace {

flow::Options with_focal_length(flow::Options options, double focal_length) {
  options.focal_length = static_cast<float>(focal_length);
  return options;
}

work::MachineConfig cluster_machine(const RunRequest& request) {
  return {.cores = request.cores,
          .memory = "L1",
          .capacity = request.platform.config.cluster.l1.size,
          .alignment = 4,
          .record = true,
          .code = &platform::compiled_code()};
}

}  // namespace

FlowSource::FlowSource(const RunRequest& request, flow::Options options)
    : data_(traces::open_recording(request.data, {.frames = request.frames})),
      camera_(data_, options.side),
      options_(with_focal_length(options, camera_.focal_length())),
      cluster_(cluster_machine(request)),
      estimator_(flow::make_estimator(true, options_, cluster_)) {}

bool FlowSource::begin_frame(const soc::FrameStart& start) {
  frame_ = start.frame;
  return false;
}

Eigen::Vector3d FlowSource::rate_before(int frame) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  if (frame == 0) return sum;
  const auto samples = traces::imu_between(data_.imu, time_ns(frame - 1), time_ns(frame));
  if (samples.empty()) return sum;
  for (const traces::ImuSample& sample : samples) sum += sample.gyro;
  const Eigen::Vector3d mean = sum / static_cast<double>(samples.size());
  return data_.camera.T_body_camera.rotation().transpose() * mean;
}

const work::Job& FlowSource::process(FrameResult& result) {
  const std::vector<std::uint8_t> pixels = camera_.read(static_cast<std::size_t>(frame_));
  const Eigen::Vector3d rate = rate_before(frame_);
  const std::int64_t dt_ns = frame_ > 0 ? time_ns(frame_) - time_ns(frame_ - 1) : 0;
  flows_.push_back(estimator_->process({pixels.data(), static_cast<float>(rate.x()),
                                        static_cast<float>(rate.y()),
                                        static_cast<float>(static_cast<double>(dt_ns) * 1e-9)}));
  result.index = frame_;
  result.t_ns = time_ns(frame_);
  job_ = cluster_.take_job();
  return job_;
}

const work::Job& FlowSource::optimise() { check_failed("optical flow has no optimiser", {}); }

std::vector<StageResult> FlowSource::empty_stages() const {
  std::vector<StageResult> stages;
  for (const char* name : flow::kStages) {
    StageResult stage;
    stage.name = name;
    stage.unit = "frame";
    stages.push_back(std::move(stage));
  }
  return stages;
}

RunSubject FlowSource::subject() const {
  return {"px4flow", std::llround(1e9 / data_.camera.rate_hz), options_.side, options_.side};
}

void FlowSource::describe(RunResult& result) const {
  const Bytes image(std::int64_t{options_.side} * options_.side);
  result.l2.push_back(
      {"camera", image * 2, {{"image", Bytes(0), image}, {"image being received", image, image}}});
  result.trajectory.clear();  // there are no poses
}

}  // namespace leviosim::tools
