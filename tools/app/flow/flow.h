// The optical flow over a data set, as work for a simulation: a second workload beside LEVIO
// (run/live_source.h), which the same chips, tables and figures serve. Frames come as recorded; no
// optimiser.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/work/machine.h"
#include "tools/app/result/run_result.h"
#include "tools/app/run/run_request.h"
#include "tools/app/run/simulate.h"
#include "tools/app/table/table_files.h"
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

// What `leviosim flow` prints and writes. Pure functions of the result.

// Published figures of PX4FLOW on the chips that we have platforms of, and such figures from a run.
// tools/app/validation/published/px4flow.csv, compiled into the program.

/// What of a run a published figure is compared with.
enum class FlowFigure : std::uint8_t { FrameRate, SpeedUp, Power };

struct PublishedFlow {
  std::string platform;  ///< name of the platform
  FlowFigure figure;
  int cores = 1;
  double clock_mhz = 0;
  std::optional<double> rate;  ///< frames/s at which the power was measured
  double value = 0;
  std::string unit;
  std::string source;
};

/// All of them. @throws InputError with line and column
std::vector<PublishedFlow> published_flow();

std::string_view name_of(FlowFigure figure);

/// The figure from a run, absent if it has none: on a chip without energy figures, or
/// with another number of cores. The published clock may be another than the run's: then all clocks
/// are scaled in proportion, cycles stay the same, and the voltage is the lowest that allows it.
std::optional<double> predicted(const PublishedFlow& published, const RunResult& run);

/// A run's work with frames at another, even rate.
RunResult at_rate(RunResult run, double frames_per_second);

/// Cycles of a frame, on average over all but the first, which has no flow.
struct FlowCycles {
  double single = 0;
  double parallel = 0;
};
/// Absent for a run of less than two frames.
std::optional<FlowCycles> flow_cycles(const RunResult& run);

/// A run of the optical flow: what every workload has, and its flows, one for each frame.
struct FlowRun {
  RunResult run;
  std::vector<flow::Flow> flows;
  std::string platform;        ///< the chip's own name
  int binning = 1;             ///< of the camera
  std::optional<double> rate;  ///< frames/s that was asked for; the recorded one if absent
};

/// Frames/s that the chip could do, on one core and on all.
std::string frame_rate_table(const FlowRun& flow);

/// Published figures of this chip beside those of the run; empty if there are none.
std::string published_table(const FlowRun& flow);

/// How many frames have a flow, and how large it is.
std::string flow_summary(const FlowRun& flow);

/// All that is printed, with the tables that all workloads share, as parts of a screen.
std::vector<std::string> flow_report(const FlowRun& flow);

/// Whether the chip keeps up with the camera, in a sentence.
std::string flow_conclusion(const FlowRun& flow);

/// A row per frame.
Table flow_rows(const FlowRun& flow);

/// The rows of published_table().
Table published_rows(const FlowRun& flow);

}  // namespace leviosim::tools
