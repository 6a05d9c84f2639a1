// The points of a sweep held against a budget (tools/app/budget): every finished point must meet
// every limit that is for it. Limits with a sign are relative to the first point of the plan.
//
// Left out: reasons by mechanism, for which a sweep keeps too little; compare has them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/app/budget/budget.h"
#include "tools/app/study/sweep/plan.h"
#include "tools/app/study/sweep/points.h"
#include "tools/app/study/sweep/sweep_inputs.h"
#include "tools/app/study/sweep/sweep_store.h"

namespace leviosim::tools {

struct SweepCheck {
  std::size_t held = 0;
  std::size_t missed = 0;  ///< points with a limit that is not met, or that cannot run
  std::string verdict;     ///< in a sentence
  std::string text;        ///< how many, and a table of them
};

/// @throws InputError for figures that the points do not have, Interrupted
SweepCheck check_sweep(const Budget& budget, const SweepPlan& plan,
                       const std::vector<SweepPoint>& points, SweepInputs& inputs,
                       SweepStore& store);

}  // namespace leviosim::tools
