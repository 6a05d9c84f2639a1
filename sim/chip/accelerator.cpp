#include "sim/chip/accelerator.h"

#include <fmt/format.h>

#include <algorithm>

#include "sim/base/check.h"
#include "sim/work/op.h"

namespace leviosim::sim {

bool has_accelerators(const Accelerators& accelerators) {
  return std::any_of(accelerators.begin(), accelerators.end(),
                     [](const AcceleratorConfig& a) { return a.units > 0; });
}

bool has_accelerators(const ChipConfig& chip) {
  return has_accelerators(chip.cluster.accelerators) ||
         has_accelerators(chip.controller.accelerators);
}

work::Counts left_to_core(const work::Segment& segment, const Accelerators& accelerators) {
  work::Counts left = segment;
  for (const work::OffloadWork& calls : segment.offload) {
    if (accelerators[work::index(calls.kernel)].units == 0) continue;
    for (std::size_t i = 0; i < work::kOpCount; ++i) {
      if (calls.counts.n[i] > left.n[i]) [[unlikely]]
        check_failed(fmt::format("offload regions of {} counted {} {}, their segment has {} left",
                                 work::kOffloadKinds[work::index(calls.kernel)].name,
                                 calls.counts.n[i], work::kOps[i].name, left.n[i]),
                     SourceLine::current());
      left.n[i] -= calls.counts.n[i];
    }
  }
  return left;
}

Service service_of(const work::OffloadWork& calls, const Accelerators& accelerators) {
  const AcceleratorConfig& accelerator = accelerators[work::index(calls.kernel)];
  if (accelerator.units == 0) return {};
  const auto number = static_cast<double>(calls.calls);
  const double busy = static_cast<double>(calls.items) / accelerator.items_per_cycle;
  return {number * accelerator.start_up, number * accelerator.latency + busy, busy,
          busy * accelerator.l1_words};
}

Demand demand_of(const work::Segment& segment, const CoreCosts& core,
                 const Accelerators& accelerators, const CodeFetcher& code,
                 OperationAccounts* by_operation) {
  if (segment.offload.empty() || !has_accelerators(accelerators))
    return demand_of(static_cast<const work::Counts&>(segment), core, code, by_operation);
  Demand demand = demand_of(left_to_core(segment, accelerators), core, code, by_operation);
  for (const work::OffloadWork& calls : segment.offload) {
    if (accelerators[work::index(calls.kernel)].units == 0) continue;
    const Service service = service_of(calls, accelerators);
    LoneCycles alone;
    alone[Mechanism::Issue] = service.instructions;
    alone[Mechanism::Accelerator] = service.waiting;
    demand.alone += alone;
    if (by_operation != nullptr) {
      OperationAccount& account = (*by_operation)[operation_of(calls.kernel)];
      account.count += static_cast<double>(calls.items);
      account.cycles += alone;
    }
    demand.scattered += service.l1_words;
    UnitDemand& unit = demand.units[static_cast<std::size_t>(accelerator_of(calls.kernel))];
    if (service.busy > 0) unit = {static_cast<double>(calls.calls), service.busy};
  }
  return demand;
}

}  // namespace leviosim::sim
