#include "tools/app/study/sweep/pareto_front.h"

#include <algorithm>
#include <limits>

#include "tools/app/study/spread.h"
#include "tools/app/study/sweep/point_run.h"
#include "tools/app/study/sweep/sweep_store.h"

namespace leviosim::tools {
namespace {

using Values = std::array<double, kObjectives.size()>;

Values values_of(const SweepOutcome& outcome) {
  Values values{};
  for (std::size_t k = 0; k < values.size(); ++k)
    values[k] = outcome.objectives[k].value_or(std::numeric_limits<double>::infinity());
  return values;
}

bool dominates(const Values& a, const Values& b) {
  bool better = false;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (a[k] > b[k]) return false;
    better = better || a[k] < b[k];
  }
  return better;
}

}  // namespace

bool dominates(const SweepOutcome& a, const SweepOutcome& b) {
  return dominates(values_of(a), values_of(b));
}

std::vector<SweepOutcome> pareto_front(const std::vector<SweepOutcome>& outcomes) {
  struct Candidate {
    Values values;
    const SweepOutcome* outcome;
  };
  std::vector<Candidate> sorted;
  for (const SweepOutcome& o : outcomes)
    if (o.failure.empty()) sorted.push_back({values_of(o), &o});
  std::sort(sorted.begin(), sorted.end(), [](const Candidate& a, const Candidate& b) {
    return a.values != b.values ? a.values < b.values : a.outcome->point < b.outcome->point;
  });
  // What dominates a point comes before it, and if that is dominated itself, so does what is on the
  // front: each has to be compared with the front so far only.
  std::vector<Candidate> front;
  for (const Candidate& c : sorted)
    if (std::none_of(front.begin(), front.end(),
                     [&](const Candidate& f) { return dominates(f.values, c.values); }))
      front.push_back(c);
  std::vector<SweepOutcome> result;
  for (const Candidate& c : front) result.push_back(*c.outcome);
  return result;
}

}  // namespace leviosim::tools
