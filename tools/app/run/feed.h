// The input of the workload: the frames of a data set with their IMU samples, prepared on a host
// thread of its own while the simulation works on the frame before.
#pragma once

#include <future>
#include <span>
#include <vector>

#include "tools/app/result/run_result.h"
#include "tools/app/run/run_request.h"
#include "traces/datasets/dataset.h"
#include "traces/datasets/image_source.h"
#include "traces/trajectories/trajectory.h"
#include "workload/vio/records.h"

namespace leviosim::tools {

class Feed {
 public:
  /// @throws InputError for data that cannot be used
  explicit Feed(const RunRequest& request);

  /// Without the ground truth.
  const traces::Dataset& data() const { return data_; }
  const traces::Trajectory& truth() const { return truth_; }
  const vio::Rig& rig() const { return rig_; }
  /// Frames per second of the camera.
  double rate_hz() const { return rate_hz_; }
  int size() const { return static_cast<int>(frames_.size()); }
  std::int64_t time_ns(int i) const { return data_.frames[camera_frame(i).recorded].t_ns; }
  std::int64_t arrival_ns(int i) const { return camera_frame(i).arrival_ns; }

  /// The input of frame i, with all IMU samples since the frame taken before. Frames are taken in
  /// order, but some may be left out. Valid until the next call.
  const vio::FrameInput& frame(int i);

 private:
  const soc::CameraFrame& camera_frame(int i) const { return frames_[static_cast<std::size_t>(i)]; }
  traces::GrayImage read(int i) const { return images_.read(camera_frame(i).recorded); }
  traces::GrayImage take_image(int i);
  std::span<const traces::ImuSample> imu_of(int i) const;

  traces::Dataset data_;
  traces::Trajectory truth_;
  std::vector<soc::CameraFrame> frames_;
  double rate_hz_;
  traces::ImageSource images_;
  vio::Rig rig_;
  int last_ = -1;  ///< frame that was taken last
  std::future<traces::GrayImage> next_;
  int next_frame_ = -1;  ///< frame that next_ prepares
  traces::GrayImage image_;
  vio::FrameInput input_;
};

/// What a run of that profile is of.
RunSubject subject_of(const std::string& profile, const Feed& feed);

}  // namespace leviosim::tools
