// Looks on while a run happens and keeps when everything happened (frame_events.h).
#pragma once

#include <optional>

#include "tools/app/run/run_observer.h"
#include "tools/app/timeline/frame_events.h"

namespace leviosim::tools {

class TimelineCollector : public RunObserver {
 public:
  /// @param cores  of the team
  /// @param range  frames to keep, by their numbers in the run; all if absent
  /// @param middle  if not 0: so many frames in the middle of the run in place of all
  TimelineCollector(const sim::ChipConfig& chip, int cores,
                    std::optional<traces::FrameRange> range = {}, int middle = 0);

  bool wants_steps() const override { return true; }
  /// @throws InputError for a range that is not of the run
  void on_start(const RunSubject& subject, int frames) override;
  void on_front_end(const FrontEndJob& job) override;
  void on_optimiser(const OptimiserJob& job) override;

  const TimelineEvents& events() const { return events_; }
  /// What happened is known elsewhere now.
  void forget();

 private:
  std::vector<StageEvents> stages_of(const work::Job& job, const sim::JobTiming& timing,
                                     bool on_controller);
  StepEvents step_of(const sim::StepTiming& timing, std::string_view clock) const;

  int middle_;
  RunResult job_run_;  ///< a run of one job, for its energy
  TimelineEvents events_;
};

}  // namespace leviosim::tools
