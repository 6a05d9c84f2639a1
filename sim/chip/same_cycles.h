// Whether jobs take as many cycles on one chip as on another: what a job takes depends on cores,
// caches, units, memories, DMA and events of a chip, and on how fast its clocks run to each other,
// but not on supply, energies, areas, or sizes of memories that the work fits in.
#pragma once

#include "sim/chip/config.h"

namespace leviosim::sim {

/// @param external  whether the work moves data from or to external memory, which takes seconds
bool takes_same_cycles(const ChipConfig& a, const ChipConfig& b, bool external = true);

}  // namespace leviosim::sim
