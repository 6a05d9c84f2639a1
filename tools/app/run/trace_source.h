// A source of recorded work: what `leviosim replay` runs on. It computes nothing, so where the chip
// at hand is faster or slower than that of the recording, the work stays the same. Differences in
// what the algorithm would have seen are noted frame by frame:
//
//   - another result of the optimiser, or none, when the frame began;
//   - an optimisation that would not have begun, since the optimiser is still busy: it is left out;
//   - an optimisation that would have begun, but was not recorded: it is missing.
//
// A frame that had to wait is noted too. With a queue, that alone changes nothing that is computed.
#pragma once

#include "tools/app/run/run_source.h"
#include "traces/work_traces/work_frames.h"
#include "traces/work_traces/work_trace.h"

namespace leviosim::tools {
/// How a frame began, in the recording and now.
struct FrameComparison {
  struct Start {
    std::int64_t waited_ns = 0;  ///< wait since the camera delivered it [ns]
    bool optimiser_busy = false;
    bool optimised = false;  ///< an optimisation began
    int seen = -1;           ///< optimisation whose result it saw, as FrameStart::seen
  };
  int frame = 0;
  Start recorded;
  Start replayed;

  bool sees_another_result() const { return recorded.seen != replayed.seen; }
  bool optimiser_differs() const { return recorded.optimiser_busy != replayed.optimiser_busy; }
  /// Without regard to earlier frames.
  bool computes_the_same() const { return !sees_another_result() && !optimiser_differs(); }
};

/// RunSource::empty_stages() of recorded work.
std::vector<StageResult> stages_of(const traces::WorkTrace& trace);

/// RunSource::subject() and describe() of recorded work.
RunSubject subject_of(const traces::WorkTrace& trace);
void describe_recording(const traces::WorkTrace& trace, RunResult& result);

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
  std::vector<StageResult> empty_stages() const override { return stages_of(trace_); }
  RunSubject subject() const override { return subject_of(trace_); }
  void describe(RunResult& result) const override;

  /// Of the frames so far.
  const std::vector<FrameComparison>& comparisons() const { return comparisons_; }

 private:
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

/// @param memory  "L1" or "L2"
/// @throws work::MemoryOverflow naming the frame and the stage whose recorded work does not fit
void check_fits(const traces::WorkTrace& trace, int frame, const work::Job& job, const char* memory,
                Bytes size);

}  // namespace leviosim::tools
