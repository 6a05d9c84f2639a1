#include "tools/app/timeline/perfetto_timeline.h"

#include <fmt/core.h>

#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

#include "tools/app/result/camera_figures.h"
#include "tools/app/result/energy_summary.h"
#include "tools/app/timeline/core_slices.h"
#include "tools/app/timeline/joined_steps.h"
#include "tools/app/timeline/timeline_collector.h"
#include "tools/app/timeline/track_events.h"
#include "workload/vio/odometry/odometry.h"

namespace leviosim::tools {
namespace {

/// Numbers of tracks, in the order in which they are shown. Cores and what is below them follow.
enum TrackNumber : std::uint64_t { kRoot = 1, kCamera, kDeadlines, kFrontEnd, kFirstCore };

/// The first step length that is joined; it doubles until a frame fits.
constexpr Cycles kFirstShortest{100};

constexpr double kMilliwatts = 1e3;

std::uint64_t flow_of_frame(int frame) { return 2 * static_cast<std::uint64_t>(frame) + 2; }
std::uint64_t flow_of_snapshot(int frame) { return flow_of_frame(frame) + 1; }

/// What of L2 stays occupied between the iterations; the camera's part is in no stage's peak.
Bytes resting_l2(const work::StageRun& stage) {
  for (const work::Block& block : stage.memory.blocks)
    if (block.name == vio::kPersistentBlock) return block.size;
  return {};
}

}  // namespace

class PerfettoTimeline::Writer {
 public:
  Writer(const sim::ChipConfig& chip, const Options& options, outputs::Sink sink)
      : chip_(chip),
        options_(options),
        sink_(std::move(sink)),
        collector_(chip, options.cores, options.range) {
    RunResult nothing;
    nothing.chip = chip;
    nothing.cores = options.cores;
    if (const auto energy = energy_of(nothing, Seconds(1)))
      idle_power_ = energy->rows.back().power();
  }

  void begin(const RunSubject& subject, int frames);
  void add_front_end(const FrontEndJob& job);
  void add_iteration(const OptimiserJob& job);
  void end(const RunResult& run);

 private:
  const TimelineEvents& events() const { return collector_.events(); }
  std::int64_t ns(sim::Time time) const { return nanoseconds(events().timebase, time); }
  void add_tracks();
  void add_camera(const RunResult& run);
  void add_arrival(int frame, std::int64_t arrival_ns, bool dropped, bool late);
  void add_frame(const FrameEvents& frame);
  void join_until_it_fits(const std::function<void(Cycles shortest)>& write, Cycles all);
  void add_front_end_slices(const FrameEvents& frame);
  void add_counters(const FrameEvents& frame);
  void add_iteration(const IterationEvents& iteration, const work::Job& job);
  void end_optimisation();
  void flush() { sink_(writer_.take()); }

  const sim::ChipConfig& chip_;
  Options options_;
  outputs::Sink sink_;
  TimelineCollector collector_;  ///< of what is not written yet
  RunSubject subject_;
  Bytes camera_l2_;
  ClusterTracks cluster_;
  std::uint64_t controller_ = 0;
  std::uint64_t l1_ = 0;
  std::uint64_t l2_ = 0;
  std::uint64_t stage_power_ = 0;
  std::uint64_t controller_power_ = 0;
  TrackEventWriter writer_;
  /// Of the chip while the cluster has no work; absent if its energy is not known.
  std::optional<sim::Estimate<Watts>> idle_power_;
  /// Of the optimisation that has begun and has not ended.
  struct Open {
    std::int64_t end_ns = 0;  ///< of its last iteration so far
    Bytes resting;            ///< of L2, after it
  };
  std::optional<Open> open_;
};

void PerfettoTimeline::Writer::add_tracks() {
  int rank = 0;
  std::uint64_t number = kFirstCore;
  const auto add = [&](std::string_view name, std::uint64_t track) {
    writer_.add_track({track, name, kRoot, rank++});
    return track;
  };
  const auto add_counter = [&](std::string_view name, CounterUnit unit) {
    writer_.add_counter_track({number, name, kRoot, rank++}, unit);
    return number++;
  };
  writer_.add_root({kRoot, fmt::format("leviosim: {} on {}", subject_.profile, chip_.name)});
  add("camera", kCamera);
  add("deadlines", kDeadlines);
  add("front end", kFrontEnd);
  const std::uint64_t master = add("master", number++);
  for (int core = 0; core < events().cores; ++core)
    cluster_.cores.push_back(add(fmt::format("core {}", core), number++));
  cluster_.cores.push_back(master);
  const auto add_transfers = [&](std::string_view name, work::Direction direction) {
    cluster_.transfers[static_cast<std::size_t>(direction)] = add(name, number++);
  };
  add_transfers("DMA, L2 to L1", work::Direction::L2ToL1);
  add_transfers("DMA, L1 to L2", work::Direction::L1ToL2);
  if (chip_.controller.external.size > Bytes(0)) {
    add_transfers("external memory to L2", work::Direction::ExternalToL2);
    add_transfers("L2 to external memory", work::Direction::L2ToExternal);
  }
  controller_ = add("controller", number++);
  l1_ = add_counter("L1, peak of the stage", CounterUnit::Bytes);
  l2_ = add_counter("L2, peak of the stage", CounterUnit::Bytes);
  if (!idle_power_) return;
  stage_power_ = add_counter("power without controller", CounterUnit::Milliwatts);
  controller_power_ = add_counter("power of the controller", CounterUnit::Milliwatts);
}

void PerfettoTimeline::Writer::add_arrival(int frame, std::int64_t arrival_ns, bool dropped,
                                           bool late) {
  if (!events().holds(frame)) return;
  const std::string name = fmt::format("frame {}{}", frame, dropped ? " dropped" : "");
  EventText arrival{name, true, {{"frame", std::int64_t{frame}}, {"dropped", dropped}}};
  if (!dropped) arrival.flows = {flow_of_frame(frame)};
  writer_.instant(kCamera, arrival_ns, arrival);
  writer_.instant(kDeadlines, arrival_ns + subject_.frame_period_ns,
                  {dropped || late ? "deadline missed" : "deadline met",
                   false,
                   {{"frame", std::int64_t{frame}}}});
}

void PerfettoTimeline::Writer::add_camera(const RunResult& run) {
  auto frame = run.frames.begin();
  const std::size_t arrivals = run.camera ? run.camera->deliveries.size() : run.frames.size();
  for (std::size_t i = 0; i < arrivals; ++i) {
    const soc::Delivery* delivery = run.camera ? &run.camera->deliveries[i] : nullptr;
    const bool dropped = delivery != nullptr && delivery->dropped;
    add_arrival(delivery != nullptr ? delivery->frame : frame->index,
                delivery != nullptr ? delivery->arrival_ns : frame->arrival_ns, dropped,
                !dropped && is_late(*frame, subject_));
    if (!dropped) ++frame;
    flush();
  }
}

/// Steps that are shorter than the least of 0, 100, 200, 400 … cycles with which it fits are
/// joined.
/// @param all  cycles of which nothing can be joined any more
void PerfettoTimeline::Writer::join_until_it_fits(const std::function<void(Cycles shortest)>& write,
                                                  Cycles all) {
  const TrackEventWriter::Mark mark = writer_.mark();
  write(Cycles(0));
  for (Cycles shortest = kFirstShortest; writer_.size() - mark.bytes > options_.most_bytes;
       shortest = shortest * 2) {
    writer_.rewind(mark);
    write(shortest);
    if (shortest > all) return;
  }
}

void PerfettoTimeline::Writer::add_frame(const FrameEvents& frame) {
  const auto write = [&](Cycles shortest) {
    add_front_end_slices(frame);
    CoreSlices cores(cluster_, events().timebase, "cluster", frame.work_begin, writer_);
    for (const StageEvents& stage : frame.stages)
      cores.add(with_short_steps_joined(stage, shortest));
  };
  join_until_it_fits(write, frame.result.cycles);
}

void PerfettoTimeline::Writer::add_front_end_slices(const FrameEvents& frame) {
  const FrameResult& result = frame.result;
  const std::string name = fmt::format("frame {}", frame.frame);
  const bool late = is_late(result, subject_);
  EventText text{name,
                 true,
                 {{"frame", std::int64_t{frame.frame}},
                  {"t_ns", result.t_ns},
                  {"pose from", vio::name_of(result.source)},
                  {"keyframe", result.keyframe},
                  {"late", late},
                  {"cycles", result.cycles.count()}},
                 {flow_of_frame(frame.frame)}};
  writer_.begin(kFrontEnd, result.start_ns, text);
  if (frame.optimisation_begun)
    writer_.instant(kFrontEnd, result.start_ns,
                    {"snapshot", false, {}, {flow_of_snapshot(frame.frame)}});
  const sim::ClockDomain& clock = events().timebase.clock("cluster");
  for (const StageEvents& stage : frame.stages) {
    const std::int64_t cycle = clock.whole_cycles(stage.begin - frame.work_begin).count();
    writer_.begin(kFrontEnd, ns(stage.begin),
                  {stage.name, false, {{"cycle", cycle}, {"cycles", stage.cycles.count()}}});
    writer_.end(kFrontEnd, ns(stage.end));
  }
  writer_.end(kFrontEnd, result.end_ns);
  writer_.instant(kFrontEnd, result.end_ns,
                  {late ? "pose, late" : "pose", false, {}, {}, {flow_of_frame(frame.frame)}});
}

void PerfettoTimeline::Writer::add_counters(const FrameEvents& frame) {
  for (const StageEvents& stage : frame.stages) {
    writer_.counter(l1_, ns(stage.begin), stage.memory.count());
    if (stage.power)
      writer_.counter(stage_power_, ns(stage.begin), stage.power->count() * kMilliwatts);
  }
  if (frame.stages.empty()) return;
  const std::int64_t end_ns = ns(frame.stages.back().end);
  writer_.counter(l1_, end_ns, std::int64_t{0});
  if (idle_power_) writer_.counter(stage_power_, end_ns, idle_power_->value.count() * kMilliwatts);
}

/// Within a slice from the first to the last of the optimisation, with the arrow from its snapshot.
void PerfettoTimeline::Writer::add_iteration(const IterationEvents& iteration,
                                             const work::Job& job) {
  const std::uint64_t flow = flow_of_snapshot(iteration.frame);
  if (!open_) {
    writer_.begin(controller_, ns(iteration.begin),
                  {"optimisation", false, {{"frame", std::int64_t{iteration.frame}}}, {flow}});
    open_ = Open{};
  }
  for (std::size_t i = 0; i < iteration.stages.size(); ++i) {
    const StageEvents& stage = iteration.stages[i];
    const std::int64_t begin_ns = ns(stage.begin);
    open_->resting = resting_l2(job.stages[i]) + camera_l2_;
    writer_.begin(
        controller_, begin_ns,
        {stage.name,
         false,
         {{"iteration", std::int64_t{iteration.iteration}}, {"cycles", stage.cycles.count()}}});
    writer_.end(controller_, ns(stage.end));
    writer_.counter(l2_, begin_ns, std::max(open_->resting, stage.memory + camera_l2_).count());
    if (stage.power)
      writer_.counter(controller_power_, begin_ns, stage.power->count() * kMilliwatts);
  }
  open_->end_ns = ns(iteration.end);
  Cycles all;
  for (const StageEvents& stage : iteration.stages) all += stage.cycles;
  const auto write = [&](Cycles shortest) {
    CoreSlices transfers(cluster_, events().timebase, "controller", iteration.begin, writer_);
    for (const StageEvents& stage : iteration.stages)
      transfers.add_transfers(with_short_steps_joined(stage, shortest));
  };
  join_until_it_fits(write, all);
  if (!iteration.last) return;
  const std::int64_t end_ns = open_->end_ns;
  end_optimisation();
  writer_.instant(controller_, end_ns, {"published", false, {}, {}, {flow}});
}

void PerfettoTimeline::Writer::end_optimisation() {
  if (!open_) return;
  writer_.end(controller_, open_->end_ns);
  writer_.counter(l2_, open_->end_ns, open_->resting.count());
  if (idle_power_) writer_.counter(controller_power_, open_->end_ns, 0.0);
  open_.reset();
}

void PerfettoTimeline::Writer::begin(const RunSubject& subject, int frames) {
  collector_.on_start(subject, frames);
  subject_ = subject;
  if (options_.is_closed)
    camera_l2_ = soc::second_buffer(subject.image_width, subject.image_height);
  add_tracks();
  flush();
}

void PerfettoTimeline::Writer::add_front_end(const FrontEndJob& job) {
  collector_.on_front_end(job);
  for (const FrameEvents& frame : events().frames) {
    add_frame(frame);
    add_counters(frame);
  }
  collector_.forget();
  flush();
}

void PerfettoTimeline::Writer::add_iteration(const OptimiserJob& job) {
  collector_.on_optimiser(job);
  for (const IterationEvents& iteration : events().iterations) add_iteration(iteration, job.job);
  collector_.forget();
  flush();
}

void PerfettoTimeline::Writer::end(const RunResult& run) {
  end_optimisation();
  flush();
  add_camera(run);
}

PerfettoTimeline::PerfettoTimeline(const sim::ChipConfig& chip, const Options& options,
                                   outputs::Sink sink)
    : writer_(std::make_unique<Writer>(chip, options, std::move(sink))) {}

PerfettoTimeline::~PerfettoTimeline() = default;

void PerfettoTimeline::on_start(const RunSubject& subject, int frames) {
  writer_->begin(subject, frames);
}

void PerfettoTimeline::on_front_end(const FrontEndJob& job) { writer_->add_front_end(job); }

void PerfettoTimeline::on_optimiser(const OptimiserJob& job) { writer_->add_iteration(job); }

void PerfettoTimeline::finish(const RunResult& run) { writer_->end(run); }

}  // namespace leviosim::tools
