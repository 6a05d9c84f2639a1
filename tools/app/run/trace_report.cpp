// What is said of a work trace and of its replay, part of trace_source.h.
#include "tools/app/run/trace_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "sim/base/printable.h"
#include "sim/work/op.h"
#include "sim/work/transfers.h"
#include "tools/app/table/terminal_table.h"
#include "traces/work_traces/work_frames.h"

namespace leviosim::tools {
namespace {

/// All executions of one stage.
struct StageSum {
  std::int64_t calls = 0;
  std::int64_t segments = 0;
  std::int64_t forks = 0;
  work::Counts counts;
  work::Transferred transfers;
  Bytes peak;
};

/// Straddling is a property of accesses that are counted already.
double operations(const work::Counts& counts) {
  std::uint64_t sum = 0;
  for (const std::uint64_t n : counts.n) sum += n;
  return static_cast<double>(sum - counts[work::Op::Straddle]);
}

class Contents {
 public:
  explicit Contents(const traces::WorkTrace& trace) {
    traces::WorkFrames reader(trace, true);
    for (traces::WorkFrame frame; reader.next(frame);) {
      keyframes += frame.keyframe;
      optimised += frame.optimised;
      iterations += static_cast<std::int64_t>(frame.iterations.size());
      busy += frame.optimiser_busy;
      add(frame.front_end);
      for (const work::Job& job : frame.iterations) add(job);
    }
  }

  const StageSum& of(const std::string& stage) const {
    static const StageSum none;
    const auto found = stages_.find(stage);
    return found == stages_.end() ? none : found->second;
  }
  StageSum all() const {
    StageSum sum;
    for (const auto& [name, stage] : stages_) {
      sum.segments += stage.segments;
      sum.forks += stage.forks;
      sum.counts += stage.counts;
    }
    return sum;
  }

  std::int64_t keyframes = 0;
  std::int64_t optimised = 0;
  std::int64_t iterations = 0;
  std::int64_t busy = 0;
  work::Segment offload;  ///< calls of them

 private:
  void add(const work::Job& job) {
    for (const work::StageRun& run : job.stages) {
      StageSum& sum = stages_[std::string(run.stage)];
      ++sum.calls;
      work::Segment segment = work::segments_of(run);
      sum.counts += segment;
      offload += work::Segment({}, std::move(segment.offload));
      sum.transfers += work::transferred_by(run);
      sum.peak = std::max(sum.peak, run.memory.parallel);
      for (const work::Step& step : run.steps) {
        if (std::holds_alternative<work::Serial>(step)) ++sum.segments;
        const auto* fork = std::get_if<work::Fork>(&step);
        if (fork == nullptr) continue;
        ++sum.forks;
        sum.segments += static_cast<std::int64_t>(fork->shares.size());
      }
    }
  }

  std::map<std::string, StageSum> stages_;
};

std::string stage_table(const traces::WorkTrace& trace, const Contents& contents) {
  Table table({{"stage", kLeft},
               {"call", kLeft},
               {"calls"},
               {"forks"},
               {"work segments"},
               {"million operations"},
               {"transfers"},
               {"kB moved"},
               {"peak bytes"}});
  for (const traces::WorkTraceInfo::Stage& stage : trace.info().stages) {
    const StageSum& sum = contents.of(stage.name);
    table.add({stage.name, stage.unit, fmt::format("{}", sum.calls), fmt::format("{}", sum.forks),
               fmt::format("{}", sum.segments),
               fmt::format("{:.1f}", operations(sum.counts) * 1e-6),
               fmt::format("{}", sum.transfers.transfers),
               fmt::format("{:.1f}", static_cast<double>(sum.transfers.bytes.count()) * 1e-3),
               fmt::format("{}", sum.peak.count())});
  }
  return terminal_text(table);
}

/// What an accelerator might serve.
std::string kernel_line(const Contents& contents) {
  std::string text;
  for (const work::OffloadWork& calls : contents.offload.offload)
    text += fmt::format(
        "{}{} {} ({} %)", text.empty() ? "" : ", ",
        work::kOffloadKinds[work::index(calls.kernel)].name, calls.calls,
        std::llround(100 * operations(calls.counts) / operations(contents.all().counts)));
  return fmt::format("offload regions (share of operations): {}\n", text.empty() ? "none" : text);
}

}  // namespace

std::string trace_summary(const traces::WorkTrace& trace) {
  const Contents contents(trace);
  const traces::WorkTraceInfo& info = trace.info();
  const StageSum all = contents.all();
  const auto frames = static_cast<double>(std::max(trace.frames(), 1));
  const auto size = static_cast<double>(trace.file_size());
  return fmt::format(
             "work trace of {}, by {}\n"
             "recorded on {}, work divided among {} cores\n"
             "workload {}, seed {}, over {}, {} frames from {} on, {}x{}\n"
             "keyframes {}, optimisations {} with {} iterations, optimiser busy at {} frames\n"
             "{:.1f} kB, {:.2f} kB per frame; {:.0f} work segments per frame, {:.2f} bytes "
             "each\n\n",
             printable(trace.name()), printable(info.program), printable(info.platform), info.cores,
             printable(info.profile), info.seed, printable(info.data), trace.frames(),
             info.first_frame, info.image_width, info.image_height, contents.keyframes,
             contents.optimised, contents.iterations, contents.busy, size * 1e-3,
             size * 1e-3 / frames, static_cast<double>(all.segments) / frames,
             size / static_cast<double>(std::max(all.segments, std::int64_t{1}))) +
         stage_table(trace, contents) + kernel_line(contents);
}

}  // namespace leviosim::tools
