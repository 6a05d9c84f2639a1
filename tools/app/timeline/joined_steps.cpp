#include "tools/app/timeline/joined_steps.h"

#include <fmt/core.h>

#include <algorithm>

namespace leviosim::tools {
namespace {

void add_core(std::vector<CoreEvents>& cores, const CoreEvents& core) {
  const auto at = std::lower_bound(cores.begin(), cores.end(), core.core,
                                   [](const CoreEvents& c, int number) { return c.core < number; });
  if (at == cores.end() || at->core != core.core) {
    cores.insert(at, core);
    return;
  }
  at->end = core.end;
  at->worked += core.worked;
  at->idle += core.idle;
  at->split += core.split;
}

/// Of one direction: each begins after the one before has ended.
void add_transfer(std::vector<TransferEvents>& transfers, const TransferEvents& transfer) {
  const auto same = std::find_if(transfers.begin(), transfers.end(), [&](const TransferEvents& t) {
    return t.direction == transfer.direction;
  });
  if (same == transfers.end()) {
    transfers.push_back(transfer);
    return;
  }
  same->end = transfer.end;
  same->bytes += transfer.bytes;
  same->transfers += transfer.transfers;
  same->tiles += transfer.tiles;
}

void add_step(StepEvents& sum, const StepEvents& step) {
  sum.kind = StepKind::Several;
  sum.name = {};
  sum.end = step.end;
  sum.cycles += step.cycles;
  sum.steps += step.steps;
  sum.synchronisation += step.synchronisation;
  sum.serial += step.serial;
  sum.transfer += step.transfer;
  for (const CoreEvents& core : step.cores) add_core(sum.cores, core);
  for (const TransferEvents& transfer : step.transfers) add_transfer(sum.transfers, transfer);
}

}  // namespace

StageEvents with_short_steps_joined(const StageEvents& stage, Cycles shortest) {
  StageEvents joined = stage;
  joined.steps.clear();
  bool before_is_short = false;
  for (const StepEvents& step : stage.steps) {
    const bool is_short = step.cycles < shortest;
    if (is_short && before_is_short)
      add_step(joined.steps.back(), step);
    else
      joined.steps.push_back(step);
    before_is_short = is_short;
  }
  return joined;
}

}  // namespace leviosim::tools
