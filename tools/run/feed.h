// What the workload is fed: the frames of a data set with their IMU samples, prepared on a host
// thread of its own while the simulation works on the frame before.
#pragma once

#include <future>

#include "tools/run/run_request.h"
#include "traces/dataset.h"
#include "traces/image_source.h"
#include "workload/pipeline/odometry.h"

namespace leviosim::tools {

class Feed {
 public:
  /// @throws InputError for data that cannot be used
  explicit Feed(const RunRequest& request);

  const traces::Dataset& data() const { return data_; }
  const vio::Rig& rig() const { return rig_; }
  int size() const { return static_cast<int>(data_.frames.size()); }
  std::int64_t time_ns(int i) const { return data_.frames[static_cast<std::size_t>(i)].t_ns; }

  /// The input of frame i; frames are taken in order. Valid until the next call.
  const vio::FrameInput& frame(int i);

 private:
  traces::Dataset data_;
  traces::ImageSource images_;
  vio::Rig rig_;
  std::future<traces::GrayImage> next_;
  traces::GrayImage image_;
  vio::FrameInput input_;
};

}  // namespace leviosim::tools
