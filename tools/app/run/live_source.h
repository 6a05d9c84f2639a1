// The workload over a data set, computing as the simulation asks for its work.
#pragma once

#include <future>
#include <memory>
#include <span>
#include <vector>

#include "tools/app/run/run_request.h"
#include "tools/app/run/simulate.h"
#include "traces/datasets/dataset.h"
#include "traces/datasets/image_preparation.h"
#include "workload/vio/odometry/odometry.h"
#include "workload/vio/profile.h"
#include "workload/vio/records.h"

namespace leviosim::tools {

// What the workload is fed: the frames of a data set with their IMU samples, prepared on a host
// thread of its own while the simulation works on the frame before.

class Feed {
 public:
  /// @throws InputError for data that cannot be used
  explicit Feed(const RunRequest& request);

  const traces::Dataset& data() const { return data_; }
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
  std::vector<soc::CameraFrame> frames_;
  double rate_hz_;
  traces::ImageSource images_;
  vio::Rig rig_;
  int last_ = -1;  ///< taken before
  std::future<traces::GrayImage> next_;
  int next_frame_ = -1;  ///< which that is
  traces::GrayImage image_;
  vio::FrameInput input_;
};

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
  void describe(RunResult& result) const override;

 private:
  void evaluate(RunResult& result) const;

  vio::Profile profile_;
  bool evaluate_;
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

/// Stages that were not called yet.
std::vector<StageResult> named_stages(const std::vector<vio::StageName>& names);

}  // namespace leviosim::tools
