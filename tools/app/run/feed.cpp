#include "tools/app/run/feed.h"

#include <fmt/core.h>

#include <cmath>
#include <utility>

#include "traces/datasets/dataset.h"
#include "traces/datasets/image_source.h"
#include "traces/datasets/imu_samples.h"
#include "traces/recordings/recording.h"
#include "workload/vio/frame.h"

namespace leviosim::tools {
namespace {

vio::Rig make_rig(const traces::CameraModel& camera, const traces::PinholeIntrinsics& k,
                  double frame_rate) {
  vio::Rig rig{};
  rig.frame_rate = static_cast<float>(frame_rate);
  rig.camera = {static_cast<float>(k.fx), static_cast<float>(k.fy), static_cast<float>(k.cx),
                static_cast<float>(k.cy)};
  rig.width = k.width;
  rig.height = k.height;
  const Eigen::Matrix3d R = camera.T_body_camera.rotation().transpose();
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      rig.R_camera_body[static_cast<std::size_t>(3 * r + c)] = static_cast<float>(R(r, c));
  const Eigen::Vector3d p = -(R * camera.T_body_camera.translation());
  for (int r = 0; r < 3; ++r)
    rig.p_camera_body[static_cast<std::size_t>(r)] = static_cast<float>(p[r]);
  return rig;
}

float seconds(std::int64_t ns) { return static_cast<float>(static_cast<double>(ns) * 1e-9); }

vio::ImuInput to_input(const traces::ImuSample& sample, std::int64_t before_ns) {
  vio::ImuInput input{};
  input.dt = seconds(sample.t_ns - before_ns);
  for (int k = 0; k < 3; ++k) {
    input.gyro[k] = static_cast<float>(sample.gyro[k]);
    input.accel[k] = static_cast<float>(sample.accel[k]);
  }
  return input;
}

std::vector<soc::CameraFrame> camera_frames(const RunRequest& request,
                                            const traces::Dataset& data) {
  std::vector<std::int64_t> stamps_ns;
  for (const traces::FrameRef& frame : data.frames) stamps_ns.push_back(frame.t_ns);
  if (!request.camera || !request.camera->fps) return soc::all_frames(stamps_ns);
  return soc::frames_at(*request.camera->fps, stamps_ns, data.camera.rate_hz);
}

}  // namespace

Feed::Feed(const RunRequest& request)
    : data_(traces::open_recording(request.data,
                                   {.frames = request.frames, .disturbance = request.disturbance})),
      truth_(traces::to_trajectory(std::exchange(data_.ground_truth, {}))),
      frames_(camera_frames(request, data_)),
      rate_hz_(request.camera && request.camera->fps ? *request.camera->fps : data_.camera.rate_hz),
      images_(data_, request.image_size, request.pictures),
      rig_(make_rig(data_.camera, images_.intrinsics(), rate_hz_)) {
  input_.wants_features = request.film != nullptr;
}

/// Read while the frame before was worked on, if no frame was dropped since that was not dropped
/// before: what comes next is taken to be as far away as the last one was.
traces::GrayImage Feed::take_image(int i) {
  const bool foreseen = next_.valid() && next_frame_ == i;
  traces::GrayImage image = foreseen ? next_.get() : read(i);
  next_frame_ = i + (last_ < 0 ? 1 : i - last_);
  if (next_frame_ < size())
    next_ = std::async(std::launch::async, [this, k = next_frame_] { return read(k); });
  return image;
}

std::span<const traces::ImuSample> Feed::imu_of(int i) const {
  if (last_ < 0) return traces::imu_batch(data_, camera_frame(i).recorded);
  return traces::imu_between(data_.imu, time_ns(last_), time_ns(i));
}

const vio::FrameInput& Feed::frame(int i) {
  image_ = take_image(i);
  input_.pixels = image_.pixels.data();
  input_.width = image_.width;
  input_.height = image_.height;
  input_.dt = last_ >= 0 ? seconds(time_ns(i) - time_ns(last_)) : 0.0f;
  input_.imu.clear();
  for (const traces::ImuSample& sample : imu_of(i)) {
    const bool first_of_all = &sample == data_.imu.data();
    input_.imu.push_back(to_input(sample, first_of_all ? sample.t_ns : (&sample - 1)->t_ns));
  }
  last_ = i;
  return input_;
}

RunSubject subject_of(const std::string& profile, const Feed& feed) {
  return {profile, std::llround(1e9 / feed.rate_hz()), feed.rig().width, feed.rig().height};
}

}  // namespace leviosim::tools
