// Whether the accuracy of poses can be evaluated, before they are estimated.
#pragma once

#include <cstdint>
#include <vector>

#include "traces/datasets/dataset.h"

namespace leviosim::traces {

/// Throws InputError if the accuracy of poses at these times is unknown: there is ground truth,
/// but fewer than three stamps have a true pose that is close enough (EvaluationOptions). Passes
/// where there is no truth, or fewer than three stamps.
void require_truth_at(const Dataset& data, const std::vector<std::int64_t>& stamps_ns);

}  // namespace leviosim::traces
