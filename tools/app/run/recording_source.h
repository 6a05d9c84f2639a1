// A source of work that passes on another's and writes it down: what `run --record` runs on.
#pragma once

#include <deque>

#include "sim/outputs/content.h"
#include "tools/app/run/run_source.h"
#include "traces/work_traces/work_trace.h"

namespace leviosim::tools {

/// What a run leaves for its work trace.
struct WorkRecording {
  /// @param cores  among which the work of the front end is divided
  /// @param sink   as of the writer
  explicit WorkRecording(int cores, outputs::Sink sink = {}) : writer(cores, std::move(sink)) {}

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
  RunSubject subject() const override { return source_.subject(); }
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

}  // namespace leviosim::tools
