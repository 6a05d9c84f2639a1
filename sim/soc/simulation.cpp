#include "sim/soc/simulation.h"

#include <utility>

#include "sim/base/check.h"

namespace leviosim::soc {

Simulation::Simulation(const Setup& setup, JobSource& source, Observer& observer,
                       ProgressCallback progress)
    : source_(source),
      observer_(observer),
      progress_(std::move(progress)),
      chip_(setup.chip, setup.cores),
      on_one_core_(setup.on_one_core),
      single_core_(setup.chip, sim::Cluster::kMasterAlone),
      camera_frames_(chip_.kernel(), "camera frames", static_cast<std::size_t>(source.frames())),
      snapshot_taken_(chip_.kernel(), "snapshot"),
      account_(source.empty_stages(), setup.chip) {
  chip_.keep_steps(observer.wants_steps());
  chip_.keep_forks(true);
  // A flight that is too long for the chip's timebase is refused before its first frame.
  if (source.frames() > 0)
    chip_.timebase().from_nanoseconds(source.arrival_ns(source.frames() - 1));
  if (setup.deadline) {
    outcome_.camera.emplace();
    outcome_.camera->deadline = *setup.deadline;
  }
}

Outcome Simulation::run() {
  chip_.kernel().spawn("camera", camera());
  chip_.kernel().spawn_server("front end", front_end());
  chip_.kernel().spawn_server("optimiser", optimiser());
  const std::size_t blocked = chip_.kernel().run();
  check_equal(blocked, std::size_t{0}, "processes that wait for ever");
  check_equal(in_flight_, 0, "frames without a result");
  outcome_.stages = account_.stages();
  outcome_.offload = account_.offload();
  return std::move(outcome_);
}

std::int64_t Simulation::now_ns() const {
  return chip_.timebase().whole_nanoseconds(chip_.kernel().now() - sim::Time{});
}

bool Simulation::takes(int frame) {
  if (outcome_.camera) {
    const bool dropped = in_flight_ >= info_of(outcome_.camera->deadline).capacity;
    outcome_.camera->deliveries.push_back(
        {frame, source_.time_ns(frame), source_.arrival_ns(frame), in_flight_, dropped});
    if (dropped) return false;
  }
  ++in_flight_;
  return true;
}

sim::Process Simulation::camera() {
  // Whether a frame is lost shows when the instant has settled: if the front end ends in it, it is
  // free.
  const sim::Phase phase = outcome_.camera ? sim::Phase::Observe : sim::Phase::Run;
  for (int i = 0; i < source_.frames(); ++i) {
    const sim::Duration arrival = chip_.timebase().from_nanoseconds(source_.arrival_ns(i));
    co_await chip_.kernel().at(sim::Time{} + arrival, phase);
    if (takes(i)) co_await camera_frames_.push(i);
  }
}

sim::Process Simulation::front_end() {
  for (;;) {
    const int i = co_await camera_frames_.pop();
    FrameTiming times;
    times.arrival_ns = source_.arrival_ns(i);
    times.start_ns = now_ns();
    if (optimiser_busy_) ++outcome_.optimiser_late;
    const bool begun = source_.begin_frame({i, times.start_ns, optimiser_busy_, published_frame_});
    if (begun) {
      optimiser_busy_ = true;
      snapshot_frame_ = i;
      snapshot_taken_.notify();
    }
    const work::Job& job = source_.process_frame();
    account_.add_work(job);
    const sim::JobTiming timing = co_await chip_.offload(job, source_.known_cycles());
    --in_flight_;
    account_.add_parallel(timing);
    const sim::JobTiming single = on_one_core_ ? single_core_.front_end(job) : sim::JobTiming{};
    account_.add_single(single);

    times.end_ns = now_ns();
    times.cycles = chip_.cluster().clock().whole_cycles(timing.end - timing.begin);
    account_.add_offload(times.cycles, timing);
    times.single_cycles = single_core_.front_end_cycles(single);
    observer_.on_front_end({i, begun, times, job, timing, single});
    progress_({i + 1, source_.frames(), times.end_ns});
  }
}

sim::Process Simulation::optimiser() {
  for (;;) {
    co_await snapshot_taken_.wait();
    const int iterations = source_.iterations();
    for (int k = 0; k < iterations; ++k) {
      const work::Job& job = source_.optimise();
      account_.add_work(job);
      const sim::JobTiming timing = co_await chip_.control(job, source_.known_cycles());
      account_.add_parallel(timing);
      account_.add_single(timing);  // the controller is one core
      observer_.on_optimiser({snapshot_frame_, k, k + 1 == iterations, job, timing});
    }
    source_.publish();
    published_frame_ = snapshot_frame_;
    ++outcome_.optimiser_published;
    optimiser_busy_ = false;
  }
}

}  // namespace leviosim::soc
