// Why a frame took as long as it did: one frame of a recorded run beside the median frame of the
// same run, by queue, stage, mechanism and what the front end saw in both.
//
// Both frames are timed again from the recording, so that any chip can be asked about. Left out:
// the optimiser, which runs beside the front end and delays no frame.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/app/comparison/comparability.h"
#include "tools/app/comparison/main_causes.h"
#include "tools/app/run/run_observer.h"

namespace leviosim::tools {

/// When a stage of the front end ran, since the frame arrived.
struct StageSpan {
  std::string_view stage;  ///< the trace's
  double begin_ms = 0;
  double end_ms = 0;

  double ms() const { return end_ms - begin_ms; }
};

/// A frame with the account of its cycles. Times are since its arrival.
struct ExplainedFrame {
  int number = 0;  ///< number in the run, from 0
  FrameResult result;
  double waited_ms = 0;  ///< wait for the front end, which was busy with earlier frames
  double own_ms = 0;     ///< time from the start of its work to its pose
  std::vector<StageSpan> stages;
  TimedParts parts;  ///< breakdown of this frame's cycles

  double latency_ms() const { return waited_ms + own_ms; }
};

/// The frame whose own time is the median of the run; of an even number the lower one.
/// @param frames  at least one
int median_frame(const std::vector<FrameResult>& frames);
/// The frame whose pose came latest after its image; of equal ones the first.
int slowest_frame(const std::vector<FrameResult>& frames);

/// Observer of a replay that keeps the times of two frames.
class FrameWatcher : public RunObserver {
 public:
  FrameWatcher(const sim::ChipConfig& chip, int cores, int frame, int other);

  void on_front_end(const FrontEndJob& job) override;

  /// As the constructor names them. Both have been seen.
  const ExplainedFrame& frame() const { return frames_[0]; }
  const ExplainedFrame& other() const { return frames_[1]; }

 private:
  const sim::ChipConfig& chip_;
  int cores_;
  std::array<ExplainedFrame, 2> frames_;
};

/// Times of a stage in both frames, and the mechanism that explains most of the difference.
struct StageDifference {
  std::string stage;
  double median_ms = 0;
  double ms = 0;
  std::string cause;    ///< "the master works alone"; empty where the times are the same
  double cause_ms = 0;  ///< its part of the difference

  double change_ms() const { return ms - median_ms; }
};

/// The front end's stages of both frames, in their order.
std::vector<StageDifference> stage_differences(const ExplainedFrame& median,
                                               const ExplainedFrame& frame);

/// What the front end saw in both frames.
struct FactDifference {
  std::string fact;  ///< "matches with landmarks, after the age filter"
  std::string median;
  std::string frame;
};

/// The facts that differ by a tenth or more, those that differ most first.
std::vector<FactDifference> fact_differences(const ExplainedFrame& median,
                                             const ExplainedFrame& frame);

/// The answer in a sentence. @param period_ms  of the camera, the deadline of a frame
std::string why_text(const ExplainedFrame& median, const ExplainedFrame& frame, double period_ms);

/// The stages of both frames as bars of letters, one above the other, with the deadline.
/// @param width  of a line, in columns
std::string frame_bars(const ExplainedFrame& median, const ExplainedFrame& frame, double period_ms,
                       int width);

}  // namespace leviosim::tools
