#include "tools/app/flow/flow_source.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "platform_models/loader/compiled_code.h"
#include "sim/base/check.h"
#include "sim/base/error.h"
#include "traces/datasets/imu_batches.h"
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

void FlowSource::describe(RunResult& result) const {
  result.profile = "px4flow";
  result.frame_period_ns = std::llround(1e9 / data_.camera.rate_hz);
  result.image_width = result.image_height = options_.side;
  const Bytes image(std::int64_t{options_.side} * options_.side);
  result.l2.push_back(
      {"camera", image * 2, {{"image", Bytes(0), image}, {"image being received", image, image}}});
  result.trajectory.clear();  // there are no poses
}

namespace {

constexpr int kBinnedRows = 120;

int binning_for(int height) { return std::max(1, (height + kBinnedRows / 2) / kBinnedRows); }

}  // namespace

BinnedFrames::BinnedFrames(const traces::Dataset& data, int side)
    : source_(data, {data.camera.width, data.camera.height}),
      side_(side),
      binning_(binning_for(data.camera.height)) {
  const int width = data.camera.width / binning_;
  const int height = data.camera.height / binning_;
  if (std::min(width, height) < side)
    throw InputError(fmt::format(
        "{}: its images have {}x{} px after binning by {}; optical flow needs a window of {}x{}",
        data.frames_csv.string(), width, height, binning_, side, side));
}

double BinnedFrames::focal_length() const {
  return (source_.intrinsics().fx + source_.intrinsics().fy) / (2.0 * binning_);
}

std::vector<std::uint8_t> BinnedFrames::read(std::size_t frame) const {
  return binned_window(source_.read(frame), binning_, side_);
}

std::vector<std::uint8_t> binned_window(const traces::GrayImage& image, int binning, int side) {
  const int x0 = (image.width - side * binning) / 2;
  const int y0 = (image.height - side * binning) / 2;
  const int area = binning * binning;
  std::vector<std::uint8_t> window;
  window.reserve(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      int sum = 0;
      for (int j = 0; j < binning; ++j) {
        const int row = (y0 + y * binning + j) * image.width;
        for (int i = 0; i < binning; ++i)
          sum += image.pixels[static_cast<std::size_t>(row + x0 + x * binning + i)];
      }
      window.push_back(static_cast<std::uint8_t>((sum + area / 2) / area));
    }
  return window;
}

}  // namespace leviosim::tools
