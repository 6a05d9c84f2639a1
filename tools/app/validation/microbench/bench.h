// Times small programs on a chip through the interface that workloads use: a Machine records what
// the program does, the chip times it.
//
// Such programs stand for instruction streams that somebody wrote in assembly, so the platform's
// constants of code generation do not apply: no instruction is added by a compiler, only loads that
// are said to be used at once wait, and cores that run the same stream find their turns at units
// and banks that they share.
#pragma once

#include <functional>
#include <string_view>

#include "sim/chip/config.h"
#include "sim/chip/timing.h"
#include "sim/work/machine.h"
#include "sim/work/program.h"

namespace leviosim::tools {

/// The chip without what compilers add, for streams in step.
/// @param loads_used_at_once  share of loads whose result the next instruction uses
sim::ChipConfig as_assembly(sim::ChipConfig chip, double loads_used_at_once = 0);

/// What a program reads, and where its results go.
template <class P, class T>
using In = typename P::template Span<const T>;
template <class P, class T>
using Out = typename P::template Span<T>;

/// A block of memory with values that do not matter for its timing; the host fills it.
template <class Span>
Span block(work::Machine& machine, std::string_view name, int n) {
  const Span span = machine.local().alloc<Span>(name, n);
  for (int i = 0; i < n; ++i) span.data()[i] = {};
  return span;
}

class Bench {
 public:
  /// @param cores  up to the number of workers; one more, and the master takes part
  Bench(const sim::ChipConfig& chip, int cores, const work::CodeMap* code = nullptr);

  /// What the master does in one stage.
  work::Job record(const std::function<void(work::Machine&)>& body);
  sim::StageTiming time(const work::Job& job) const;

  /// Times one stage in which every core runs body(core).
  sim::StageTiming fork(const std::function<void(work::Core&)>& body);
  /// Times one stage in which the master runs body(machine).
  sim::StageTiming run(const std::function<void(work::Machine&)>& body);
  /// Seconds of one stage in which the controller runs body(machine).
  double controller_seconds(const std::function<void(work::Machine&)>& body);
  /// Cycles from the controller's call until it has the result of an empty task, in its own clock.
  double offload_cycles();

 private:
  sim::ChipConfig config_;
  bool with_master_;
  int workers_;
  work::Machine machine_;
};

/// Cycles per slot of a stream of `slots` that every core runs, forking left out.
double stream_cycles(const sim::ChipConfig& chip, int cores, int slots,
                     const std::function<void(work::Core&)>& body);

}  // namespace leviosim::tools
