#include "tools/app/run/trace_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "sim/base/printable_text.h"
#include "sim/chip/accelerator.h"
#include "sim/work/transfers.h"
#include "tools/app/report/text_table.h"

namespace leviosim::tools {
namespace {

PoseSource source_of(const traces::WorkFrame& frame, const traces::WorkTrace& trace, int number) {
  if (const auto source = vio::source_named(frame.source)) return *source;
  throw InputError(
      fmt::format("{}: frame {} has its pose from '{}', which this leviosim does not know",
                  trace.name(), number, frame.source));
}

/// What the facts of the trace are called here; null for one that this program does not know.
std::vector<const vio::FrameFact*> known_facts(const traces::WorkTraceInfo& info) {
  std::vector<const vio::FrameFact*> facts;
  for (const std::string& name : info.facts) {
    const auto fact = std::find_if(vio::kFrameFacts.begin(), vio::kFrameFacts.end(),
                                   [&](const vio::FrameFact& f) { return f.name == name; });
    facts.push_back(fact == vio::kFrameFacts.end() ? nullptr : &*fact);
  }
  return facts;
}

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
  TextTable table({{"frame"},
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
  std::string text = table.str();
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
  TextTable table({{"stage", kLeft},
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
  return table.str();
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

TraceSource::TraceSource(const traces::WorkTrace& trace, Bytes l1, Bytes l2, bool offload,
                         std::optional<work::CompiledFor> code)
    : trace_(trace),
      l1_(l1),
      l2_(l2),
      reader_(trace, offload, code),
      facts_(known_facts(trace.info())) {}

bool TraceSource::begin_frame(const soc::FrameStart& start) {
  for (; number_ < start.frame; ++number_)
    check(reader_.next(frame_), "a trace has as many frames as it has time stamps");
  const std::int64_t arrival_ns = time_ns(start.frame) - time_ns(0);
  const bool begun = frame_.optimised && !start.optimiser_busy;
  comparisons_.push_back(
      {start.frame,
       {frame_.start_ns - arrival_ns, frame_.optimiser_busy, frame_.optimised, frame_.seen},
       {start.start_ns - arrival_ns, start.optimiser_busy, begun, start.seen}});
  if (begun) {
    std::swap(iterations_, frame_.iterations);
    next_iteration_ = 0;
  }
  return begun;
}

const work::Job& TraceSource::process(FrameResult& result) {
  result.index = frame_.index;
  result.t_ns = frame_.t_ns;
  result.source = source_of(frame_, trace_, number_);
  result.keyframe = frame_.keyframe;
  for (std::size_t i = 0; i < facts_.size(); ++i)
    if (facts_[i] != nullptr) result.*facts_[i]->of = frame_.facts[i];
  result.pose = {frame_.t_ns, frame_.T_world_body};
  check_fits(frame_.front_end, "L1", l1_);
  return frame_.front_end;
}

const work::Job& TraceSource::optimise() {
  const work::Job& job = iterations_.at(next_iteration_++);
  check_fits(job, "L2", l2_);
  return job;
}

void TraceSource::check_fits(const work::Job& job, const char* memory, Bytes size) const {
  for (const work::StageRun& stage : job.stages)
    if (stage.memory.parallel > size)
      throw InputError(fmt::format(
          "{}: frame {}, {}: the recorded work occupies {} bytes of {}, which has {}: {} bytes are "
          "missing; a larger {} has them",
          trace_.name(), number_, stage.stage, stage.memory.parallel.count(), memory, size.count(),
          (stage.memory.parallel - size).count(),
          std::string_view(memory) == "L2" ? "l2.size" : "cluster.l1.size"));
}

std::vector<StageResult> TraceSource::empty_stages() const {
  std::vector<StageResult> stages;
  for (const traces::WorkTraceInfo::Stage& recorded : trace_.info().stages) {
    StageResult stage;
    stage.name = recorded.name;
    stage.unit = recorded.unit;
    stage.on_controller = recorded.on_controller;
    stages.push_back(std::move(stage));
  }
  return stages;
}

void TraceSource::describe(RunResult& result) const {
  const traces::WorkTraceInfo& info = trace_.info();
  result.profile = info.profile;
  result.frame_period_ns = info.frame_period_ns;
  result.image_width = info.image_width;
  result.image_height = info.image_height;
  for (const traces::WorkTraceInfo::Memory& memory : info.l2)
    result.l2.push_back({memory.name, memory.bytes, memory.blocks});
  result.ate = info.ate;
}

void check_cores(const traces::WorkTrace& trace, const RunRequest& request) {
  const int recorded = trace.info().cores;
  const int most = request.platform.config.cluster.max_workers;
  if (recorded > most)
    throw InputError(fmt::format("{}: its work was divided among {} cores; {} serves {} at most",
                                 trace.name(), recorded, request.platform.name, most));
  if (request.cores != recorded)
    throw InputError(fmt::format(
        "{}: its work was divided among {} cores, and how a program divides its work among {} is "
        "not in it; replay with --cores {}, or record again with run --record --cores {}",
        trace.name(), recorded, request.cores, recorded, request.cores));
}

platform::ResolvedPlatform recorded_platform(const traces::WorkTrace& trace,
                                             const std::vector<std::string>& overrides) {
  return platform::resolve_platform_text(trace.name() + ", platform of the recording",
                                         trace.info().platform_yaml, overrides);
}

Replay replay(const traces::WorkTrace& trace, const RunRequest& request,
              const ProgressCallback& progress) {
  check_cores(trace, request);
  const auto begin = std::chrono::steady_clock::now();
  const sim::ChipConfig& chip = request.platform.config;
  TraceSource source(trace, chip.cluster.l1.size, chip.l2.size, sim::has_accelerators(chip),
                     sim::code_of(chip));
  Replay result;
  result.run = simulate_source(request, source, progress);
  result.run.host_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  result.frames = source.comparisons();
  result.recorded_l1 = recorded_platform(trace).config.cluster.l1.size;
  return result;
}

bool RecordingSource::begin_frame(const soc::FrameStart& start) {
  write_complete_frames();
  const bool begun = source_.begin_frame(start);
  if (begun) {
    check_equal(iterations_left_, std::size_t{0}, "iterations left of the optimisation before");
    iterations_left_ = static_cast<std::size_t>(source_.iterations());
  }
  traces::WorkFrame& frame = frames_.emplace_back();
  frame.start_ns = start.start_ns;
  frame.optimiser_busy = start.optimiser_busy;
  frame.seen = start.seen;
  frame.optimised = begun;
  return begun;
}

const work::Job& RecordingSource::process(FrameResult& result) {
  const work::Job& job = source_.process(result);
  traces::WorkFrame& frame = frames_.back();
  frame.index = result.index;
  frame.t_ns = result.t_ns;
  frame.source = name_of(result.source);
  frame.keyframe = result.keyframe;
  frame.facts.clear();
  for (const vio::FrameFact& fact : vio::kFrameFacts) frame.facts.push_back(result.*fact.of);
  frame.T_world_body = result.pose.T_world_body;
  frame.front_end = job;
  return job;
}

const work::Job& RecordingSource::optimise() {
  const work::Job& job = source_.optimise();
  const auto optimised = std::find_if(frames_.rbegin(), frames_.rend(),
                                      [](const auto& frame) { return frame.optimised; });
  check(optimised != frames_.rend() && iterations_left_ > 0, "an iteration belongs to a frame");
  optimised->iterations.push_back(job);
  --iterations_left_;
  return job;
}

void RecordingSource::write_complete_frames() {
  for (; !frames_.empty(); frames_.pop_front()) {
    const bool in_progress = frames_.front().optimised && iterations_left_ > 0 &&
                             std::none_of(frames_.begin() + 1, frames_.end(),
                                          [](const auto& frame) { return frame.optimised; });
    if (in_progress) return;
    recording_.writer.add(frames_.front());
  }
}

void RecordingSource::finish() {
  while (iterations_left_ > 0) optimise();
  write_complete_frames();
}

void RecordingSource::describe(RunResult& result) const {
  source_.describe(result);
  traces::WorkTraceInfo& info = recording_.info;
  info.profile = result.profile;
  info.image_width = result.image_width;
  info.image_height = result.image_height;
  info.frame_period_ns = result.frame_period_ns;
  for (const vio::FrameFact& fact : vio::kFrameFacts) info.facts.emplace_back(fact.name);
  for (const StageResult& stage : empty_stages())
    info.stages.push_back({stage.name, stage.unit, stage.on_controller});
  for (const L2Row& row : result.l2) info.l2.push_back({row.name, row.bytes, row.blocks});
  info.ate = result.ate;
}

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
