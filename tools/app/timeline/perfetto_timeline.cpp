#include "tools/app/timeline/perfetto_timeline.h"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>

#include "tools/app/result/camera_figures.h"
#include "tools/app/result/energy_summary.h"
#include "tools/app/timeline/core_slices.h"
#include "tools/app/timeline/joined_steps.h"
#include "tools/app/timeline/track_events.h"

namespace leviosim::tools {
namespace {

/// Numbers of tracks, in the order in which they are shown. Cores and what is below them follow.
enum TrackNumber : std::uint64_t { kRoot = 1, kCamera, kDeadlines, kFrontEnd, kFirstCore };

/// The first step length that is joined; it doubles until a frame fits.
constexpr Cycles kFirstShortest{100};

constexpr double kMilliwatts = 1e3;

std::uint64_t flow_of_frame(int frame) { return 2 * static_cast<std::uint64_t>(frame) + 2; }
std::uint64_t flow_of_snapshot(int frame) { return flow_of_frame(frame) + 1; }

class Timeline {
 public:
  Timeline(const TimelineEvents& events, const RunResult& run)
      : events_(events), run_(run), energy_(energy_of(run)) {
    add_tracks();
  }

  void add_camera();
  void add_frame(const FrameEvents& frame, std::size_t most_bytes);
  void add_counters(const FrameEvents& frame);
  void add_optimiser();

  std::string bytes() const { return writer_.bytes(); }

 private:
  std::int64_t ns(sim::Time time) const { return nanoseconds(events_.timebase, time); }
  void add_tracks();
  void add_arrival(int frame, std::int64_t arrival_ns, bool dropped, bool late);
  void add_slices(const FrameEvents& frame, Cycles shortest);
  void add_front_end(const FrameEvents& frame);
  using Iterations = std::vector<IterationEvents>::const_iterator;
  void add_optimisation(Iterations first, Iterations end);
  void add_iteration(const IterationEvents& iteration);
  Bytes resting_l2() const;
  Bytes camera_l2() const;

  const TimelineEvents& events_;
  const RunResult& run_;
  std::optional<RunEnergy> energy_;
  ClusterTracks cluster_;
  std::uint64_t controller_ = 0;
  std::uint64_t l1_ = 0;
  std::uint64_t l2_ = 0;
  std::uint64_t stage_power_ = 0;
  std::uint64_t controller_power_ = 0;
  TrackEventWriter writer_;
};

void Timeline::add_tracks() {
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
  writer_.add_root({kRoot, fmt::format("leviosim: {} on {}", run_.profile, run_.chip.name)});
  add("camera", kCamera);
  add("deadlines", kDeadlines);
  add("front end", kFrontEnd);
  const std::uint64_t master = add("master", number++);
  for (int core = 0; core < events_.cores; ++core)
    cluster_.cores.push_back(add(fmt::format("core {}", core), number++));
  cluster_.cores.push_back(master);
  cluster_.to_l1 = add("DMA, L2 to L1", number++);
  cluster_.to_l2 = add("DMA, L1 to L2", number++);
  controller_ = add("controller", number++);
  l1_ = add_counter("L1, peak of the stage", CounterUnit::Bytes);
  l2_ = add_counter("L2, peak of the stage", CounterUnit::Bytes);
  if (!energy_) return;
  stage_power_ = add_counter("power without controller", CounterUnit::Milliwatts);
  controller_power_ = add_counter("power of the controller", CounterUnit::Milliwatts);
}

void Timeline::add_arrival(int frame, std::int64_t arrival_ns, bool dropped, bool late) {
  if (!events_.holds(frame)) return;
  const std::string name = fmt::format("frame {}{}", frame, dropped ? " dropped" : "");
  EventText arrival{name, true, {{"frame", std::int64_t{frame}}, {"dropped", dropped}}};
  if (!dropped) arrival.flows = {flow_of_frame(frame)};
  writer_.instant(kCamera, arrival_ns, arrival);
  writer_.instant(kDeadlines, arrival_ns + run_.frame_period_ns,
                  {dropped || late ? "deadline missed" : "deadline met",
                   false,
                   {{"frame", std::int64_t{frame}}}});
}

void Timeline::add_camera() {
  if (!run_.camera) {
    for (const FrameResult& frame : run_.frames)
      add_arrival(frame.index, frame.arrival_ns, false, is_late(frame, run_));
    return;
  }
  auto frame = run_.frames.begin();
  for (const soc::Delivery& delivery : run_.camera->deliveries) {
    const bool late = !delivery.dropped && is_late(*frame, run_);
    add_arrival(delivery.frame, delivery.arrival_ns, delivery.dropped, late);
    if (!delivery.dropped) ++frame;
  }
}

/// Steps that are shorter than the least of 0, 100, 200, 400 … cycles with which it fits are
/// joined.
void Timeline::add_frame(const FrameEvents& frame, std::size_t most_bytes) {
  const TrackEventWriter::Mark mark = writer_.mark();
  add_slices(frame, Cycles(0));
  for (Cycles shortest = kFirstShortest; writer_.size() - mark.bytes > most_bytes;
       shortest = shortest * 2) {
    writer_.rewind(mark);
    add_slices(frame, shortest);
    if (shortest > frame.result.cycles) return;  // there is nothing left to be joined
  }
}

void Timeline::add_slices(const FrameEvents& frame, Cycles shortest) {
  add_front_end(frame);
  CoreSlices cores(cluster_, events_.timebase, frame.work_begin, writer_);
  for (const StageEvents& stage : frame.stages) cores.add(with_short_steps_joined(stage, shortest));
}

void Timeline::add_front_end(const FrameEvents& frame) {
  const FrameResult& result = frame.result;
  const std::string name = fmt::format("frame {}", frame.frame);
  const bool late = is_late(result, run_);
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
  const sim::ClockDomain& clock = events_.timebase.clock("cluster");
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

void Timeline::add_counters(const FrameEvents& frame) {
  for (const StageEvents& stage : frame.stages) {
    writer_.counter(l1_, ns(stage.begin), stage.memory.count());
    if (stage.power)
      writer_.counter(stage_power_, ns(stage.begin), stage.power->count() * kMilliwatts);
  }
  if (frame.stages.empty()) return;
  const std::int64_t end_ns = ns(frame.stages.back().end);
  writer_.counter(l1_, end_ns, std::int64_t{0});
  if (!energy_) return;
  if (const auto idle = energy_->rows.back().power())
    writer_.counter(stage_power_, end_ns, idle->value.count() * kMilliwatts);
}

/// While no stage of the controller runs. What the camera keeps is not in the peak of a stage.
Bytes Timeline::resting_l2() const {
  Bytes sum;
  for (const L2Row& row : run_.l2)
    if (row.name != kOptimiserL2) sum += row.bytes;
  return sum;
}

Bytes Timeline::camera_l2() const {
  Bytes sum;
  for (const L2Row& row : run_.l2)
    if (row.name == kCameraL2) sum += row.bytes;
  return sum;
}

void Timeline::add_iteration(const IterationEvents& iteration) {
  for (const StageEvents& stage : iteration.stages) {
    const std::int64_t begin_ns = ns(stage.begin);
    writer_.begin(
        controller_, begin_ns,
        {stage.name,
         false,
         {{"iteration", std::int64_t{iteration.iteration}}, {"cycles", stage.cycles.count()}}});
    writer_.end(controller_, ns(stage.end));
    writer_.counter(l2_, begin_ns, std::max(resting_l2(), stage.memory + camera_l2()).count());
    if (stage.power)
      writer_.counter(controller_power_, begin_ns, stage.power->count() * kMilliwatts);
  }
}

/// Its iterations, within a slice from the first to the last, and the arrow from its snapshot.
void Timeline::add_optimisation(Iterations first, Iterations end) {
  const int frame = first->frame;
  writer_.begin(
      controller_, ns(first->begin),
      {"optimisation", false, {{"frame", std::int64_t{frame}}}, {flow_of_snapshot(frame)}});
  for (Iterations i = first; i != end; ++i) add_iteration(*i);
  const IterationEvents& last = *std::prev(end);
  const std::int64_t end_ns = ns(last.end);
  writer_.end(controller_, end_ns);
  if (last.last)
    writer_.instant(controller_, end_ns, {"published", false, {}, {}, {flow_of_snapshot(frame)}});
  writer_.counter(l2_, end_ns, resting_l2().count());
  if (energy_) writer_.counter(controller_power_, end_ns, 0.0);
}

void Timeline::add_optimiser() {
  const std::vector<IterationEvents>& list = events_.iterations;
  for (Iterations first = list.begin(); first != list.end();) {
    const Iterations end = std::find_if(
        first, list.end(), [&](const IterationEvents& i) { return i.frame != first->frame; });
    add_optimisation(first, end);
    first = end;
  }
}

}  // namespace

std::string perfetto_timeline(const TimelineEvents& events, const RunResult& run,
                              std::size_t most_bytes_of_frame) {
  Timeline timeline(events, run);
  timeline.add_camera();
  for (const FrameEvents& frame : events.frames) {
    timeline.add_frame(frame, most_bytes_of_frame);
    timeline.add_counters(frame);
  }
  timeline.add_optimiser();
  return timeline.bytes();
}

}  // namespace leviosim::tools
