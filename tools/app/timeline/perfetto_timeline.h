// The timeline of a run as a file for Perfetto's page (README.md says what its tracks mean). It is
// written while the run goes on, so that nothing of a frame is held. Same run, same bytes.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "sim/outputs/content.h"
#include "tools/app/run/run_observer.h"
#include "traces/datasets/frame_range.h"

namespace leviosim::tools {

/// What the slices of a frame take at most: if they are more, short steps are joined. With the
/// rest, such as counters and the optimiser, a frame stays below 50 kB.
inline constexpr std::size_t kMostBytesOfFrame = 47'000;

class PerfettoTimeline : public RunObserver {
 public:
  struct Options {
    int cores = 0;                               ///< of the team
    bool is_closed = false;                      ///< the loop, in which the camera has two buffers
    std::optional<traces::FrameRange> range{};   ///< frames by their numbers in the run; else all
    std::size_t most_bytes = kMostBytesOfFrame;  ///< 0: all steps that follow each other are joined
  };
  /// @param chip  outlives the timeline
  PerfettoTimeline(const sim::ChipConfig& chip, const Options& options, outputs::Sink sink);
  ~PerfettoTimeline() override;

  bool wants_steps() const override { return true; }
  /// @throws InputError for a range that is not of the run
  void on_start(const RunSubject& subject, int frames) override;
  void on_front_end(const FrontEndJob& job) override;
  void on_optimiser(const OptimiserJob& job) override;
  /// Adds what is known at the end only: the camera's frames.
  void finish(const RunResult& run);

 private:
  class Writer;
  std::unique_ptr<Writer> writer_;
};

}  // namespace leviosim::tools
