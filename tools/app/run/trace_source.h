// A source of recorded work: what `leviosim replay` runs on. It computes nothing, so where the chip
// at hand is faster or slower than that of the recording, the work stays what it was. What the
// algorithm would have seen otherwise is noted frame by frame:
//
//   - another result of the optimiser, or none, when the frame began;
//   - an optimisation that would not have begun, since the optimiser is still busy: it is left out;
//   - an optimisation that would have begun, but was not recorded: it is missing.
//
// A frame that had to wait is noted too. With a queue, that alone changes nothing that is computed.
#pragma once

#include <deque>
#include <string>

#include "tools/app/record/statistics.h"
#include "tools/app/run/run_request.h"
#include "tools/app/run/simulate.h"
#include "traces/work_traces/work_frames.h"
#include "traces/work_traces/work_trace.h"

namespace leviosim::tools {
/// How a frame began, in the recording and now.
struct FrameComparison {
  struct Start {
    std::int64_t waited_ns = 0;  ///< since the camera delivered it
    bool optimiser_busy = false;
    bool optimised = false;  ///< an optimisation began
    int seen = -1;           ///< as FrameStart::seen
  };
  int frame = 0;
  Start recorded;
  Start replayed;

  bool sees_another_result() const { return recorded.seen != replayed.seen; }
  bool optimiser_differs() const { return recorded.optimiser_busy != replayed.optimiser_busy; }
  /// Without regard to earlier frames.
  bool computes_the_same() const { return !sees_another_result() && !optimiser_differs(); }
};

class TraceSource : public RunSource {
 public:
  /// @param trace  outlives the source and all names in what it gives
  /// @param l1,l2    sizes of the memories that the work has to fit in
  /// @param offload  whether offload regions are needed: by chips with accelerators
  /// @param code     whose compiled work is needed; all by default
  TraceSource(const traces::WorkTrace& trace, Bytes l1, Bytes l2, bool offload = false,
              std::optional<work::CompiledFor> code = {});

  int frames() const override { return trace_.frames(); }
  std::int64_t time_ns(int frame) const override {
    return trace_.info().stamps_ns[static_cast<std::size_t>(frame)];
  }
  bool begin_frame(const soc::FrameStart& start) override;
  /// @throws InputError naming the stage if it does not fit in L1
  const work::Job& process(FrameResult& result) override;
  int iterations() const override { return static_cast<int>(iterations_.size()); }
  /// @throws InputError naming the stage if it does not fit in L2
  const work::Job& optimise() override;
  void publish() override {}
  std::vector<StageResult> empty_stages() const override;
  void describe(RunResult& result) const override;

  /// Of the frames so far.
  const std::vector<FrameComparison>& comparisons() const { return comparisons_; }

 private:
  void check_fits(const work::Job& job, const char* memory, Bytes size) const;

  const traces::WorkTrace& trace_;
  Bytes l1_;
  Bytes l2_;
  traces::WorkFrames reader_;
  std::vector<const vio::FrameFact*> facts_;  ///< of the trace, in its order
  traces::WorkFrame frame_;
  int number_ = -1;                    ///< of the frame
  std::vector<work::Job> iterations_;  ///< of the optimisation that began last
  std::size_t next_iteration_ = 0;
  std::vector<FrameComparison> comparisons_;
};

/// RunSource::describe() of recorded work.
void describe_recording(const traces::WorkTrace& trace, RunResult& result);

// A recorded run on another chip: the same work, timed anew in the same loop of camera, front end
// and optimiser.

struct Replay {
  RunResult run;  ///< names of blocks in it are the trace's
  std::vector<FrameComparison> frames;
  Bytes recorded_l1;  ///< size of L1 on the chip of the recording
};

/// The platform that the trace was recorded on, with what was overridden then.
platform::ResolvedPlatform recorded_platform(const traces::WorkTrace& trace,
                                             const std::vector<std::string>& overrides = {});

/// @throws InputError for another number of cores than the work was divided among
void check_cores(const traces::WorkTrace& trace, const RunRequest& request);

/// @param request  gives platform, cores and observer; the rest is the trace's
/// @throws InputError if the work does not fit the chip: another number of cores than it was
/// divided
///         among, too little memory
Replay replay(const traces::WorkTrace& trace, const RunRequest& request,
              const ProgressCallback& progress);

// A source of work that passes on another's and writes it down: what `run --record` runs on.

/// What a run leaves for its work trace.
struct WorkRecording {
  /// @param cores  among which the work of the front end is divided
  explicit WorkRecording(int cores) : writer(cores) {}

  traces::WorkTraceWriter writer;
  traces::WorkTraceInfo info;  ///< as far as the source knows it
};

class RecordingSource : public RunSource {
 public:
  /// Both outlive the source.
  RecordingSource(RunSource& source, WorkRecording& recording)
      : source_(source), recording_(recording) {}

  int frames() const override { return source_.frames(); }
  std::int64_t time_ns(int frame) const override { return source_.time_ns(frame); }
  std::int64_t arrival_ns(int frame) const override { return source_.arrival_ns(frame); }
  bool begin_frame(const soc::FrameStart& start) override;
  const work::Job& process(FrameResult& result) override;
  int iterations() const override { return source_.iterations(); }
  const work::Job& optimise() override;
  void publish() override { source_.publish(); }
  std::vector<StageResult> empty_stages() const override { return source_.empty_stages(); }
  void describe(RunResult& result) const override;

  /// After the run. It may have ended within an optimisation, which a faster chip would finish: its
  /// other iterations are computed now.
  void finish();

 private:
  /// Hands over the frames whose optimisation is complete, in order, but for the last `waiting`.
  void write_complete_frames(int waiting);
  void correct_earlier(const FrameResult& result);

  RunSource& source_;
  WorkRecording& recording_;
  /// Not yet written: the first may wait for its optimisation, which goes on during later frames,
  /// or for a frame that corrects its pose.
  std::deque<traces::WorkFrame> frames_;
  std::size_t iterations_left_ = 0;
};

// What `leviosim replay` says beyond what a run says: in which frames the recorded algorithm would
// have seen something else on this chip.

/// Sums, and the first frames that differ.
std::string replay_report(const Replay& replay, const traces::WorkTrace& trace);

/// A row per frame: how it began in the recording and now.
std::string replay_csv(const Replay& replay);

/// For the manifest: what was recorded, and the digest of the trace.
Json recording_json(const traces::WorkTrace& trace, const std::string& sha256);

// What a work trace holds, for people.

/// Reads all frames. @throws InputError for what cannot be replayed
std::string trace_summary(const traces::WorkTrace& trace);

}  // namespace leviosim::tools
