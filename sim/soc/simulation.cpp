#include "sim/soc/simulation.h"

#include <chrono>
#include <utility>

#include "sim/base/check.h"
#include "tools/app/run/live_source.h"
#include "tools/app/run/recording_source.h"

namespace leviosim::tools {
namespace {

/// Fills in what does not depend on timing.
void describe(RunResult& result, const RunRequest& request, const JobSource& source) {
  const sim::ChipConfig& chip = request.platform.config;
  result.timed = !request.native;
  result.cores = request.cores;
  result.cluster_clock = chip.cluster.clock;
  result.controller_clock = chip.controller.clock;
  if (result.timed) result.chip = chip;
  result.l1_size = chip.cluster.l1.size;
  result.l2_size = chip.l2.size;
  for (const FrameResult& frame : result.frames) {
    if (frame.pose.T_world_body.matrix().allFinite())
      result.trajectory.push_back(frame.pose);
    else
      ++result.poses_left_out;
  }
  source.describe(result);
}

/// The golden model: the same computation without a chip. The optimiser's result of a frame is
/// published before the next one, as on a chip that keeps up.
RunResult run_natively(const RunRequest& request, const ProgressCallback& progress) {
  LiveSource source(request);
  RunResult result;
  for (int i = 0; i < source.frames(); ++i) {
    const bool optimising = source.take_up({.frame = i});
    FrameResult frame;
    source.process_frame(frame);
    for (int k = 0; optimising && k < source.iterations(); ++k) source.optimise();
    if (optimising) {
      source.publish();
      ++result.optimiser_published;
    }
    result.frames.push_back(frame);
    progress({i + 1, source.frames(), source.time_ns(i) - source.time_ns(0)});
  }
  describe(result, request, source);
  return result;
}

RunResult run_on_chip(const RunRequest& request, const ProgressCallback& progress) {
  LiveSource live(request);
  if (request.recording == nullptr) return Simulation(request, live, progress).run();
  RecordingSource recorded(live, *request.recording);
  RunResult result = Simulation(request, recorded, progress).run();
  recorded.finish();
  return result;
}

}  // namespace

Simulation::Simulation(const RunRequest& request, JobSource& source, ProgressCallback progress)
    : request_(request),
      source_(source),
      progress_(std::move(progress)),
      chip_(request.platform.config, request.cores),
      single_core_(request.platform.config, 1),
      camera_frames_(chip_.kernel(), "camera frames", static_cast<std::size_t>(source.frames())),
      snapshot_taken_(chip_.kernel(), "snapshot"),
      book_(source.empty_stages(), request.platform.config) {
  // A flight that is too long for the chip's timebase is refused before its first frame.
  if (source.frames() > 0)
    chip_.timebase().from_nanoseconds(source.arrival_ns(source.frames() - 1));
  if (request.camera) {
    result_.camera.emplace();
    result_.camera->deadline = request.camera->deadline;
  }
}

RunResult Simulation::run() {
  chip_.kernel().spawn("camera", camera());
  chip_.kernel().spawn_server("front end", front_end());
  chip_.kernel().spawn_server("optimiser", optimiser());
  const std::size_t blocked = chip_.kernel().run();
  check_equal(blocked, std::size_t{0}, "processes that wait for ever");
  check_equal(in_hand_, 0, "frames without a pose");
  return take_result();
}

std::int64_t Simulation::now_ns() const {
  return chip_.timebase().whole_nanoseconds(chip_.kernel().now() - sim::Time{});
}

bool Simulation::takes(int frame) {
  if (result_.camera) {
    const bool dropped = in_hand_ >= info_of(result_.camera->deadline).capacity;
    result_.camera->deliveries.push_back(
        {frame, source_.time_ns(frame), source_.arrival_ns(frame), in_hand_, dropped});
    if (dropped) return false;
  }
  ++in_hand_;
  return true;
}

sim::Process Simulation::camera() {
  // Whether a frame is lost shows when the instant has settled: if the front end ends in it, it is
  // free.
  const sim::Phase phase = result_.camera ? sim::Phase::Observe : sim::Phase::Run;
  for (int i = 0; i < source_.frames(); ++i) {
    const sim::Duration arrival = chip_.timebase().from_nanoseconds(source_.arrival_ns(i));
    co_await chip_.kernel().at(sim::Time{} + arrival, phase);
    if (takes(i)) co_await camera_frames_.push(i);
  }
}

sim::Process Simulation::front_end() {
  for (;;) {
    const int i = co_await camera_frames_.pop();
    FrameResult frame;
    frame.arrival_ns = source_.arrival_ns(i);
    frame.start_ns = now_ns();
    if (optimiser_busy_) ++result_.optimiser_late;
    const bool begun = source_.take_up({i, frame.start_ns, optimiser_busy_, published_frame_});
    if (begun) {
      optimiser_busy_ = true;
      snapshot_frame_ = i;
      snapshot_taken_.notify();
    }
    const work::Job& job = source_.process_frame(frame);
    book_.add_work(job);
    const sim::JobTiming timing = co_await chip_.offload(job);
    --in_hand_;
    book_.add_parallel(timing);
    const sim::JobTiming single = single_core_.front_end(job);
    book_.add_single(single);

    frame.end_ns = now_ns();
    frame.cycles = chip_.cluster().clock().whole_cycles(timing.end - timing.begin);
    frame.single_cycles = single_core_.front_end_cycles(single);
    result_.frames.push_back(frame);
    if (request_.observer != nullptr)
      request_.observer->on_front_end({i, begun, frame, job, timing, single});
    progress_({i + 1, source_.frames(), frame.end_ns});
  }
}

sim::Process Simulation::optimiser() {
  for (;;) {
    co_await snapshot_taken_.wait();
    const int iterations = source_.iterations();
    for (int k = 0; k < iterations; ++k) {
      const work::Job& job = source_.optimise();
      book_.add_work(job);
      const sim::JobTiming timing = co_await chip_.control(job);
      book_.add_parallel(timing);
      book_.add_single(timing);  // the controller is one core
      if (request_.observer != nullptr)
        request_.observer->on_optimiser({snapshot_frame_, k, k + 1 == iterations, job, timing});
    }
    source_.publish();
    published_frame_ = snapshot_frame_;
    ++result_.optimiser_published;
    optimiser_busy_ = false;
  }
}

RunResult Simulation::take_result() {
  result_.stages = book_.stages();
  describe(result_, request_, source_);
  // What persists in L2 lies below whatever the controller allocates; it has rows of its own.
  Bytes persistent;
  for (const L2Row& row : result_.l2) persistent += row.bytes;
  L2Row optimiser{"optimiser", Bytes(0), {}};
  for (const StageResult& stage : result_.stages) {
    if (!stage.on_controller || stage.memory.parallel <= optimiser.bytes + persistent) continue;
    optimiser = {"optimiser", stage.memory.parallel - persistent, stage.memory.blocks};
    std::erase_if(optimiser.blocks,
                  [](const work::Block& block) { return block.name == vio::kPersistentBlock; });
  }
  if (optimiser.bytes > Bytes(0)) result_.l2.push_back(optimiser);
  if (result_.camera) {
    const Bytes size = second_buffer(result_.image_width, result_.image_height);
    result_.l2.push_back({"camera", size, {{"second image buffer", Bytes(0), size}}});
  }
  return std::move(result_);
}

RunResult simulate(const RunRequest& request, const ProgressCallback& progress) {
  const auto begin = std::chrono::steady_clock::now();
  RunResult result =
      request.native ? run_natively(request, progress) : run_on_chip(request, progress);
  result.host_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

}  // namespace leviosim::tools
