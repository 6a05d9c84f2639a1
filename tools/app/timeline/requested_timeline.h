// The timeline that a command was asked for: its options, and what the command does with it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "sim/outputs/output_folder.h"
#include "tools/app/run/run_request.h"
#include "tools/app/run/simulate.h"
#include "tools/app/timeline/frame_events.h"
#include "traces/datasets/dataset.h"

namespace CLI {
class App;
}

namespace leviosim::tools {

// Looks on while a run happens and keeps when everything happened (frame_events.h).

class TimelineCollector : public RunObserver {
 public:
  /// @param cores  of the team
  /// @param range  frames to keep, by their numbers in the run; all if absent
  /// @param middle  if not 0: so many frames in the middle of the run in place of all
  TimelineCollector(const sim::ChipConfig& chip, int cores,
                    std::optional<traces::FrameRange> range = {}, int middle = 0);

  bool wants_steps() const override { return true; }
  /// @throws InputError for a range that is not of the run
  void on_start(int frames) override;
  void on_front_end(const FrontEndJob& job) override;
  void on_optimiser(const OptimiserJob& job) override;

  const TimelineEvents& events() const { return events_; }

 private:
  std::vector<StageEvents> stages_of(const work::Job& job, const sim::JobTiming& timing,
                                     bool on_controller);
  StepEvents step_of(const sim::StepTiming& timing) const;

  int middle_;
  RunResult job_run_;  ///< a run of one job, for its energy
  TimelineEvents events_;
};

struct TimelineOptions {
  std::string file;
  std::string frames;
};

/// Declares --timeline and --timeline-frames.
void add_timeline_options(CLI::App& command, TimelineOptions& options);

class RequestedTimeline {
 public:
  /// Claims the file.
  /// @param results  what the command was asked to write else: a folder, in which the file is not
  /// @throws InputError for options that contradict the request, or a file that cannot be written
  RequestedTimeline(const TimelineOptions& options, const outputs::OutputRequest& results,
                    const RunRequest& request);

  /// To look on while the run happens.
  RunObserver& observer() { return collector_; }
  /// Writes the file: a picture if its name ends in .svg. @throws InputError if that fails
  /// @param prints_name  with a line that tells its name; not where the printout is whole (JSON)
  void publish(const RunResult& run, bool prints_name);

 private:
  std::string name_;
  bool is_picture_;
  bool chosen_;  ///< its frames, since the user named none
  TimelineCollector collector_;
  std::optional<outputs::OutputFile> file_;
};

/// None without --timeline. @throws InputError as RequestedTimeline, and for --timeline-frames
/// alone
std::optional<RequestedTimeline> requested_timeline(const TimelineOptions& options,
                                                    const outputs::OutputRequest& results,
                                                    const RunRequest& request);

// The timeline of a run as a file for Perfetto's page (README.md says what its tracks mean). Same
// events, same bytes.

/// What the slices of a frame take at most: if they are more, short steps are joined. With the
/// rest, such as counters and the optimiser, a frame stays below 50 kB.
inline constexpr std::size_t kMostBytesOfFrame = 47'000;

/// @param run  that the events are of
/// @param most_bytes_of_frame  0: all steps that follow each other are joined
std::string perfetto_timeline(const TimelineEvents& events, const RunResult& run,
                              std::size_t most_bytes_of_frame = kMostBytesOfFrame);

// Joins steps that are too short to be seen apart, so that a frame of thousands of them can still
// be shown. What is joined keeps its sums: cycles of each core by what they went to, bytes moved.

/// The stage with its neighbouring steps joined into one, wherever two or more follow each other
/// that take less than `shortest` each. The work of each core in them becomes one segment, from its
/// first work to its last; their transfers become one in each direction.
StageEvents with_short_steps_joined(const StageEvents& stage, Cycles shortest);

// The timeline of a run as a picture for documents, deterministic SVG: stages of the front end,
// what each core works and waits for, transfers, the controller. The file for Perfetto
// (perfetto_timeline.cpp) has every slice; here a column of the picture shows the shares of its
// time.

/// @param run  that the events are of
std::string timeline_picture(const TimelineEvents& events, const RunResult& run);

}  // namespace leviosim::tools
