#include "sim/chip/timing.h"

namespace leviosim::sim {

CycleBreakdown& CycleBreakdown::operator+=(const CycleBreakdown& o) {
  useful += o.useful;
  fpu += o.fpu;
  divider += o.divider;
  banks += o.banks;
  fetch += o.fetch;
  accelerator += o.accelerator;
  imbalance += o.imbalance;
  synchronisation += o.synchronisation;
  transfer += o.transfer;
  serial += o.serial;
  rounding += o.rounding;
  return *this;
}

SegmentTime& SegmentTime::operator+=(const SegmentTime& o) {
  alone += o.alone;
  fpu += o.fpu;
  divider += o.divider;
  banks += o.banks;
  fetch += o.fetch;
  accelerator += o.accelerator;
  rounding += o.rounding;
  return *this;
}

}  // namespace leviosim::sim
