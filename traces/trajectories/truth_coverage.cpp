#include "traces/trajectories/truth_coverage.h"

#include <fmt/core.h>

#include "sim/base/error.h"
#include "traces/trajectories/evaluation.h"

namespace leviosim::traces {

void require_truth_at(const Dataset& data, const std::vector<std::int64_t>& stamps_ns) {
  constexpr std::size_t kFewest = 3;
  if (data.ground_truth.empty() || stamps_ns.size() < kFewest) return;
  Trajectory frames;
  for (const std::int64_t t_ns : stamps_ns) frames.push_back({t_ns, {}});
  const EvaluationOptions how;
  const std::size_t matched =
      associate(frames, to_trajectory(data.ground_truth), how.max_gap_ns).size();
  if (matched >= kFewest) return;
  throw InputError(fmt::format(
      "{}: {} of the {} frames ({} to {} ns) {} a true pose within {:g} ms; expected at least {}, "
      "or no ground truth (it spans {} to {} ns)",
      data.truth_csv.string(),
      matched == 0 ? "none" : fmt::format("{}", matched), stamps_ns.size(), stamps_ns.front(),
      stamps_ns.back(), matched > 1 ? "have" : "has", static_cast<double>(how.max_gap_ns) * 1e-6,
      kFewest, data.ground_truth.front().t_ns, data.ground_truth.back().t_ns));
}

}  // namespace leviosim::traces
