// Accelerators: hardware that does what a kernel computes. A call that a chip can serve is taken
// out of the work of its core, which instead starts a unit, waits until it is done, and goes on.
//
// Models: instructions of the core that start the unit and fetch the result; a fixed latency,
// during which the unit already serves others; a throughput; units of which any serves any core,
// and which serve requests in turn if they are asked for more than they can do (contention.h); the
// words of L1 that a unit moves while it works, at places that have nothing to do with each other;
// energy of an item (energy/model.h).
//
// Leaves out: other work of the core while it waits; that the code of the kernel need not be
// fetched (work/offload_regions.h); how the result of the hardware differs from that of the
// software; area, leakage.
#pragma once

#include "sim/chip/config.h"
#include "sim/chip/cost.h"
#include "sim/work/offload_regions.h"

namespace leviosim::sim {

/// Whether there is an accelerator for any kind of kernel.
bool has_accelerators(const Accelerators& accelerators);
bool has_accelerators(const ChipConfig& chip);

/// What is left for the core to execute.
work::Counts left_to_core(const work::Segment& segment, const Accelerators& accelerators);

/// What calls of one kind ask of their accelerator.
struct Service {
  double instructions = 0;  ///< of the core
  double waiting = 0;       ///< cycles of the core if nobody else asks
  double busy = 0;          ///< cycles of a unit
  double l1_words = 0;
};
/// None if there is no accelerator for them.
Service service_of(const work::OffloadWork& calls, const Accelerators& accelerators);

/// As demand_of() of cost.h, with the calls that accelerators serve.
Demand demand_of(const work::Segment& segment, const CoreCosts& core,
                 const Accelerators& accelerators, const CodeFetcher& code = {},
                 OperationAccounts* by_operation = nullptr);

}  // namespace leviosim::sim
