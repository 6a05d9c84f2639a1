#include "tools/run/feed.h"

#include "traces/asl_reader.h"
#include "traces/imu_batches.h"

namespace leviosim::tools {
namespace {

vio::Rig make_rig(const traces::CameraModel& camera, const traces::PinholeIntrinsics& k) {
  vio::Rig rig{};
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

}  // namespace

Feed::Feed(const RunRequest& request)
    : data_(traces::open_asl(request.data, {.frames = request.frames})),
      images_(data_, request.image_size),
      rig_(make_rig(data_.camera, images_.intrinsics())) {}

const vio::FrameInput& Feed::frame(int i) {
  const auto read = [this](int k) { return images_.read(static_cast<std::size_t>(k)); };
  image_ = next_.valid() ? next_.get() : read(i);
  if (i + 1 < size()) next_ = std::async(std::launch::async, read, i + 1);
  input_.pixels = image_.pixels.data();
  input_.width = image_.width;
  input_.height = image_.height;
  input_.dt = i > 0 ? seconds(time_ns(i) - time_ns(i - 1)) : 0.0f;
  input_.imu.clear();
  const auto batch = traces::imu_batch(data_, static_cast<std::size_t>(i));
  for (const traces::ImuSample& sample : batch) {
    const bool first_of_all = &sample == data_.imu.data();
    input_.imu.push_back(to_input(sample, first_of_all ? sample.t_ns : (&sample - 1)->t_ns));
  }
  return input_;
}

}  // namespace leviosim::tools
