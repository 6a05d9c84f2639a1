// The difference of the cycles of a stage in two runs, split by mechanism, by fork and by cause.
// What the parts leave over stands in a part of its own, "rest", so that all adds up.
#pragma once

#include "tools/app/comparison/comparison.h"

namespace leviosim::tools {

/// @param frames_a,frames_b  that the cycles are divided by
ComparedQuantity split_by_mechanism(const StageParts* a, const StageParts* b, double frames_a,
                                    double frames_b);
ComparedQuantity split_by_fork(const StageParts* a, const StageParts* b, double frames_a,
                               double frames_b);
Causes split_by_cause(const StageParts* a, const StageParts* b, double frames_a, double frames_b);

}  // namespace leviosim::tools
