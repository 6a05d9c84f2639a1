// Events per second of the event kernel beside SystemC, on the same process networks in one run.
//
// One iteration runs a network once in each kernel, one after the other, so that all meet the same
// host load; the figures are medians over iterations, of processor time. The reported time is
// leviosim's. Counters:
//   events_per_second          leviosim: steps (waits got past) per second
//   systemc_thread_per_second  the network as SC_THREADs, which is what leviosim processes replace
//   systemc_method_per_second  the network as SC_METHODs with hand-written states
//   speedup_vs_systemc         leviosim over the SC_THREADs: the same way of writing processes
//   speedup_vs_systemc_method  leviosim over the SC_METHODs
// SystemC owns main(); link with -lsystemc and -lbenchmark, without benchmark_main.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <ctime>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tests/bench/event_kernel_leviosim.h"
#include "tests/bench/event_kernel_systemc.h"

namespace leviosim::bench {
namespace {

using Run = std::function<RunResult()>;

/// One network in the three kernels.
struct Contest {
  std::string name;
  Run own;
  Run systemc_thread;
  Run systemc_method;
  bool same_cycles = true;  // false where the order of ties, which SystemC leaves open, moves ends
};

/// Everything that must stay alive while the benchmarks run.
struct SystemcNetworks {
  std::vector<std::shared_ptr<void>> networks;
  std::vector<std::unique_ptr<sc_core::sc_module>> modules;

  template <class Network, class Module>
  Run make(std::size_t processes, int rounds) {
    auto network = std::make_shared<Network>(processes, rounds);
    systemc::add_modules<Module>(modules, *network, 0, processes);
    networks.push_back(network);
    return [network] { return network->run(); };
  }
};

template <class Network>
Run make_own(std::size_t processes, int rounds) {
  return [network = std::make_shared<Network>(processes, rounds)] { return network->run(); };
}

std::vector<Contest> make_contests(SystemcNetworks& all) {
  std::vector<Contest> contests;
  for (const std::size_t processes : {9U, 128U}) {
    const int rounds = 20'000 / static_cast<int>(processes);
    const Run thread =
        all.make<systemc::DelayBarrierNet, systemc::DelayBarrierThread>(processes, rounds);
    const Run method =
        all.make<systemc::DelayBarrierNet, systemc::DelayBarrierMethod>(processes, rounds);
    const std::string size = fmt::format("/{}", processes);
    contests.push_back(
        {"delay_barrier" + size, make_own<own::DelayBarrier>(processes, rounds), thread, method});
    contests.push_back({"delay_barrier_in_tasks" + size,
                        make_own<own::TaskBarrier>(processes, rounds), thread, method});
  }
  contests.push_back({"event_ring/9", make_own<own::Ring>(9, 20'000),
                      all.make<systemc::RingNet, systemc::RingThread>(9, 20'000),
                      all.make<systemc::RingNet, systemc::RingMethod>(9, 20'000)});
  contests.push_back({"fifo_pipeline/9", make_own<own::Pipeline>(9, 8'000),
                      all.make<systemc::PipelineNet, systemc::PipelineThread>(9, 8'000),
                      all.make<systemc::PipelineNet, systemc::PipelineMethod>(9, 8'000)});
  contests.push_back({"shared_rate/9", make_own<own::SharedRate>(9, 4'000),
                      all.make<systemc::SharedRateNet, systemc::SharedRateThread>(9, 4'000),
                      all.make<systemc::SharedRateNet, systemc::SharedRateMethod>(9, 4'000),
                      false});
  return contests;
}

/// Median of steps per second over the iterations of one contender.
class Rate {
 public:
  /// Runs once; returns the seconds of processor time it took.
  double measure(const Run& run) {
    const std::clock_t begin = std::clock();
    result = run();
    const double elapsed = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    rates_.push_back(static_cast<double>(result.steps) / elapsed);
    return elapsed;
  }
  double median() {
    const auto middle = rates_.begin() + static_cast<std::ptrdiff_t>(rates_.size() / 2);
    std::nth_element(rates_.begin(), middle, rates_.end());
    return *middle;
  }

  RunResult result;

 private:
  std::vector<double> rates_;
};

bool same_shape(const Contest& contest, const RunResult& a, const RunResult& b) {
  return a.steps == b.steps && (a.cycles == b.cycles || !contest.same_cycles);
}

void compare(benchmark::State& state, const Contest& contest) {
  Rate own;
  Rate thread;
  Rate method;
  for (auto _ : state) {
    state.SetIterationTime(own.measure(contest.own));
    thread.measure(contest.systemc_thread);
    method.measure(contest.systemc_method);
    if (!same_shape(contest, own.result, thread.result) ||
        !same_shape(contest, own.result, method.result)) {
      state.SkipWithError("the networks did not do the same steps in the same simulated time");
      return;
    }
  }
  state.counters["events_per_second"] = own.median();
  state.counters["systemc_thread_per_second"] = thread.median();
  state.counters["systemc_method_per_second"] = method.median();
  state.counters["speedup_vs_systemc"] = own.median() / thread.median();
  state.counters["speedup_vs_systemc_method"] = own.median() / method.median();
}

}  // namespace
}  // namespace leviosim::bench

int sc_main(int argc, char** argv) {
  using namespace leviosim::bench;
  SystemcNetworks systemc_networks;
  const std::vector<Contest> contests = make_contests(systemc_networks);
  sc_core::sc_start(sc_core::SC_ZERO_TIME);  // elaborates; every process now waits for its start

  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  for (const Contest& contest : contests)
    benchmark::RegisterBenchmark(contest.name.c_str(),
                                 [&contest](benchmark::State& state) { compare(state, contest); })
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
