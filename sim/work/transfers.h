// How much a piece of work moved between L1 and L2.
#pragma once

#include <cstdint>

#include "sim/work/program.h"

namespace leviosim::work {

/// A plain value: add two to merge two pieces of work.
struct Transferred {
  std::int64_t transfers = 0;
  Bytes bytes;  ///< of all transfers, both directions

  Transferred& operator+=(const Transferred& o) {
    transfers += o.transfers;
    bytes += o.bytes;
    return *this;
  }
};

/// All transfers of a stage.
inline Transferred transferred_by(const StageRun& stage) {
  Transferred sum;
  for (const Step& step : stage.steps)
    if (const auto* transfer = std::get_if<Transfer>(&step)) sum += {1, transfer->bytes};
  return sum;
}

}  // namespace leviosim::work
