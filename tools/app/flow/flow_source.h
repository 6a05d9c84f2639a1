// The optical flow over a data set, as work for a simulation: a second workload beside LEVIO
// (run/live_source.h), which the same chips, tables and figures serve. Frames come as recorded; no
// optimiser.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "tools/app/run/run_request.h"
#include "tools/app/run/simulate.h"
#include "traces/datasets/dataset.h"
#include "traces/datasets/image_preparation.h"
#include "workload/flow/estimator.h"

namespace leviosim::tools {

// Frames of a data set as the camera of the optical flow delivers them: k × k pixels of the sensor
// are one of the image (binning: their mean, rounded), and a square window in the middle is read
// out. Both are functions of the sensor (Aptina MT9V034, on PX4FLOW and in EuRoC's rig), so the
// chip has nothing to do with them. PX4FLOW bins 752×480 px by 4 and reads 64×64 of 188×120.
//
// Other cameras are binned so that some 120 rows remain. Lens distortion is taken out before, which
// the published camera does not do; in the window it is below a pixel.

class BinnedFrames {
 public:
  /// @param side  of the window, px
  /// @throws InputError if the binned images are smaller
  BinnedFrames(const traces::Dataset& data, int side);

  int binning() const { return binning_; }
  /// Of the binned image, px; the mean of both axes.
  double focal_length() const;
  /// side × side grey levels. @throws InputError for images that cannot be read
  std::vector<std::uint8_t> read(std::size_t frame) const;

 private:
  traces::ImageSource source_;
  int side_;
  int binning_;
};

/// The middle of an image whose pixels are means of binning × binning ones.
std::vector<std::uint8_t> binned_window(const traces::GrayImage& image, int binning, int side);

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
