// What is said of a work trace and of its replay, part of trace_source.h.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "sim/base/text.h"
#include "sim/work/op.h"
#include "sim/work/transfers.h"
#include "tools/app/run/trace_source.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {
namespace {

constexpr std::size_t kMostRows = 10;

/// "busy", "begins", or "idle": what the optimiser does when a frame begins.
std::string_view optimiser_of(const FrameComparison::Start& start) {
  if (start.optimiser_busy) return "busy";
  return start.optimised ? "begins" : "idle";
}

bool newly_queued(const FrameComparison& frame) {
  return frame.replayed.waited_ns > 0 && frame.recorded.waited_ns == 0;
}

bool is_worth_a_row(const FrameComparison& frame) {
  return !frame.computes_the_same() || newly_queued(frame);
}

std::string seen_text(int seen) { return seen < 0 ? "none" : fmt::format("frame {}", seen); }

std::string ms(std::int64_t ns) { return fmt::format("{:.2f}", static_cast<double>(ns) * 1e-6); }

std::string differing_frames(const Replay& replay) {
  Table table({{"frame"},
               {"optimiser: recorded", kLeft},
               {"here", kLeft},
               {"result seen: recorded", kLeft},
               {"here", kLeft},
               {"waited ms: recorded"},
               {"here"}});
  std::size_t rows = 0;
  for (const FrameComparison& frame : replay.frames) {
    if (!is_worth_a_row(frame) || ++rows > kMostRows) continue;
    const FrameComparison::Start& a = frame.recorded;
    const FrameComparison::Start& b = frame.replayed;
    table.add({fmt::format("{}", frame.frame), std::string(optimiser_of(a)),
               std::string(optimiser_of(b)), seen_text(a.seen), seen_text(b.seen), ms(a.waited_ns),
               ms(b.waited_ns)});
  }
  if (rows == 0) return {};
  std::string text = terminal_text(table);
  if (rows > kMostRows) text += fmt::format("… and {} more in replay.csv\n", rows - kMostRows);
  return text;
}

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

std::string replay_report(const Replay& replay, const traces::WorkTrace& trace) {
  const auto count = [&](auto&& predicate) {
    return std::count_if(replay.frames.begin(), replay.frames.end(), predicate);
  };
  const auto differs = [](const FrameComparison& f) { return !f.computes_the_same(); };
  const auto first = std::find_if(replay.frames.begin(), replay.frames.end(), differs);
  std::string text =
      fmt::format("replay of {}, recorded on {} with {} cores\n", printable(trace.name()),
                  printable(trace.info().platform), trace.info().cores);
  if (first == replay.frames.end())
    text +=
        "in every frame the algorithm sees what it saw in the recording: a run on this chip "
        "computes the same\n";
  else
    text += fmt::format(
        "a run on this chip computes something else from frame {} on; work and trajectory here are "
        "those of the recording\n"
        "  {} frames see another result of the optimiser\n"
        "  {} optimisations are left out, as the optimiser is still busy; {} might begin that were "
        "not recorded\n",
        first->frame, count([](const auto& f) { return f.sees_another_result(); }),
        count([](const auto& f) { return f.recorded.optimised && !f.replayed.optimised; }),
        count(
            [](const auto& f) { return f.recorded.optimiser_busy && !f.replayed.optimiser_busy; }));
  if (const auto queued = count(newly_queued); queued > 0)
    text += fmt::format("{} frames wait for the front end that did not in the recording\n", queued);
  if (replay.run.l1_size != replay.recorded_l1)
    text += fmt::format(
        "L1 has {} bytes instead of {}: the scratch of the cores lies elsewhere in it, but "
        "accesses "
        "that straddle words are those of the recording\n",
        replay.run.l1_size.count(), replay.recorded_l1.count());
  return text + differing_frames(replay) + '\n';
}

std::string replay_csv(const Replay& replay) {
  std::string text =
      "frame,same,recorded_optimiser,optimiser,recorded_seen_frame,seen_frame,recorded_waited_ns,"
      "waited_ns\n";
  for (const FrameComparison& f : replay.frames)
    text += fmt::format("{},{},{},{},{},{},{},{}\n", f.frame, f.computes_the_same() ? 1 : 0,
                        optimiser_of(f.recorded), optimiser_of(f.replayed), f.recorded.seen,
                        f.replayed.seen, f.recorded.waited_ns, f.replayed.waited_ns);
  return text;
}

Json recording_json(const traces::WorkTrace& trace, const std::string& sha256) {
  const traces::WorkTraceInfo& info = trace.info();
  Json json;
  json["trace_sha256"] = sha256;
  json["program"] = info.program;
  json["platform"] = info.platform;
  json["cores"] = info.cores;
  json["inputs"] = Json::array();
  for (const auto& [name, digest] : info.inputs) {
    Json& entry = json["inputs"].emplace_back(Json::object());
    entry["name"] = name;
    entry["sha256"] = digest;
  }
  return json;
}

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
