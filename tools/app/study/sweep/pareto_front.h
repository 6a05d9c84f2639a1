// The points of a sweep that no other is better than in every respect.
#pragma once

#include <vector>

#include "tools/app/html_report/page.h"
#include "tools/app/study/sweep/sweep_store.h"

namespace leviosim::tools {

/// Whether `a` is at least as good as `b` in every objective and better in one. Less is better, and
/// what is missing is worse than any number.
bool dominates(const SweepOutcome& a, const SweepOutcome& b);

/// The outcomes that no other dominates, those that failed left out; by latency, then number.
std::vector<SweepOutcome> pareto_front(const std::vector<SweepOutcome>& outcomes);

}  // namespace leviosim::tools
