// What the engine of pages times: a recorded flight at the rate of another camera, and one frame of
// it alone, with the optimisation that began with it.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "tools/app/run/trace_source.h"

namespace leviosim::tools {

/// The frames come faster or slower than they were recorded; the loop stays open.
class FlightSource : public TraceSource {
 public:
  FlightSource(const traces::WorkTrace& trace, const sim::ChipConfig& chip, bool offload,
               std::int64_t period_ns)
      : TraceSource(trace, chip.cluster.l1.size, chip.l2.size, offload, sim::code_of(chip)),
        recorded_ns_(trace.info().frame_period_ns),
        period_ns_(period_ns) {}

  std::int64_t arrival_ns(int frame) const override {
    const std::int64_t recorded = time_ns(frame) - time_ns(0);
    if (period_ns_ == recorded_ns_) return recorded;
    return std::llround(static_cast<double>(recorded) * static_cast<double>(period_ns_) /
                        static_cast<double>(recorded_ns_));
  }
  RunSubject subject() const override {
    RunSubject subject = TraceSource::subject();
    subject.frame_period_ns = period_ns_;
    return subject;
  }

 private:
  std::int64_t recorded_ns_;
  std::int64_t period_ns_;
};

class FrameSource : public RunSource {
 public:
  /// @param trace, frame  outlive the source
  FrameSource(const traces::WorkTrace& trace, const traces::WorkFrame& frame, int number,
              const sim::ChipConfig& chip, std::int64_t period_ns)
      : trace_(trace), work_(frame), number_(number), chip_(chip), period_ns_(period_ns) {}

  int frames() const override { return 1; }
  std::int64_t time_ns(int) const override { return work_.t_ns; }
  bool begin_frame(const soc::FrameStart&) override { return work_.optimised; }
  const work::Job& process(FrameResult& result) override {
    result.index = work_.index;
    result.t_ns = work_.t_ns;
    result.keyframe = work_.keyframe;
    result.pose = {work_.t_ns, work_.T_world_body};
    if (const auto source = vio::source_named(work_.source)) result.source = *source;
    check_fits(trace_, number_, work_.front_end, "L1", chip_.cluster.l1.size);
    return work_.front_end;
  }
  int iterations() const override { return static_cast<int>(work_.iterations.size()); }
  const work::Job& optimise() override {
    const work::Job& job = work_.iterations.at(next_++);
    check_fits(trace_, number_, job, "L2", chip_.l2.size);
    return job;
  }
  void publish() override {}
  std::vector<StageResult> empty_stages() const override { return stages_of(trace_); }
  RunSubject subject() const override {
    RunSubject subject = subject_of(trace_);
    subject.frame_period_ns = period_ns_;
    return subject;
  }
  void describe(RunResult& result) const override { describe_recording(trace_, result); }

 private:
  const traces::WorkTrace& trace_;
  const traces::WorkFrame& work_;
  int number_;
  const sim::ChipConfig& chip_;
  std::int64_t period_ns_;
  std::size_t next_ = 0;
};

}  // namespace leviosim::tools
