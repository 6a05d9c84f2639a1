#include "sim/soc/job_timer.h"

#include "sim/events/process.h"

namespace leviosim::soc {
namespace {

// Free functions: a coroutine must not outlive a lambda that holds what it uses.
sim::Process offload(sim::Chip& chip, const work::Job& job, sim::JobTiming& timing) {
  timing = co_await chip.offload(job);
}

sim::Process run_on_controller(sim::Chip& chip, const work::Job& job, sim::JobTiming& timing) {
  timing = co_await chip.control(job);
}

}  // namespace

sim::JobTiming JobTimer::front_end(const work::Job& job) {
  sim::JobTiming timing;
  chip_.kernel().spawn("front end", offload(chip_, job, timing));
  chip_.kernel().run();
  return timing;
}

sim::JobTiming JobTimer::optimiser(const work::Job& job) {
  sim::JobTiming timing;
  chip_.kernel().spawn("optimiser", run_on_controller(chip_, job, timing));
  chip_.kernel().run();
  return timing;
}

}  // namespace leviosim::soc
