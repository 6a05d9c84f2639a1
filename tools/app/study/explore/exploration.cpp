#include "tools/app/study/explore/exploration.h"

#include <algorithm>
#include <map>
#include <tuple>

#include "sim/base/interruption.h"

namespace leviosim::tools {
namespace {

/// The outcomes of one point, profile and sequence.
struct Values {
  std::vector<std::optional<double>> ate;
  std::vector<std::optional<double>> relative;
};
using Place = std::tuple<std::size_t, std::string, std::string>;

std::map<Place, Values> grouped(const ExplorationRuns& runs,
                                const std::vector<RunOutcome>& outcomes) {
  std::map<Place, Values> groups;
  for (std::size_t i = 0; i < runs.runs.size(); ++i) {
    const BatchRun& run = runs.runs[i];
    Values& values = groups[{runs.point[i], run.request.profile, run.sequence->name}];
    values.ate.push_back(outcomes[i].ate_m);
    values.relative.push_back(outcomes[i].relative_percent);
  }
  return groups;
}

std::optional<double> mean_of_medians(const std::vector<ExploredPoint::OfSequence>& sequences,
                                      Spread ExploredPoint::OfSequence::*figure) {
  double sum = 0;
  for (const ExploredPoint::OfSequence& s : sequences) {
    const std::optional<double>& median = (s.*figure).median;
    if (!median) return std::nullopt;
    sum += *median;
  }
  return sum / static_cast<double>(sequences.size());
}

}  // namespace

std::vector<vio::Assignment> effective(const std::vector<vio::Assignment>& point,
                                       const std::string& profile) {
  const bool use_imu = vio::profile_named(profile, 1).use_imu;
  std::vector<vio::Assignment> set;
  for (const vio::Assignment& a : point)
    if (use_imu || !a.parameter->needs_imu) set.push_back(a);
  return set;
}

ExplorationRuns exploration_runs(const BatchPlan& plan,
                                 const std::vector<std::vector<vio::Assignment>>& points) {
  ExplorationRuns all;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (const std::string& profile : plan.profiles) {
      throw_if_interrupted();
      const std::vector<vio::Assignment> set = effective(points[i], profile);
      for (const Sequence& sequence : plan.sequences)
        for (const std::uint32_t seed : plan.seeds) {
          BatchRun run = make_run(plan, sequence, profile, plan.sizes.front(), seed);
          run.request.workload.insert(run.request.workload.end(), set.begin(), set.end());
          all.runs.push_back(std::move(run));
          all.point.push_back(i);
        }
    }
  return all;
}

std::vector<ExploredPoint> explored_points(const BatchPlan& plan,
                                           const std::vector<std::vector<vio::Assignment>>& points,
                                           const ExplorationRuns& runs,
                                           const std::vector<RunOutcome>& outcomes) {
  const std::map<Place, Values> groups = grouped(runs, outcomes);
  std::vector<ExploredPoint> explored;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (const std::string& profile : plan.profiles) {
      ExploredPoint point{i, profile, effective(points[i], profile), {}, {}, {}};
      for (const std::string& sequence : sequence_names(plan)) {
        const Values& values = groups.at({i, profile, sequence});
        point.sequences.push_back({sequence, spread_of(values.ate), spread_of(values.relative)});
      }
      point.mean_ate = mean_of_medians(point.sequences, &ExploredPoint::OfSequence::ate);
      point.mean_relative = mean_of_medians(point.sequences, &ExploredPoint::OfSequence::relative);
      explored.push_back(std::move(point));
    }
  return explored;
}

const ExploredPoint* best_of(const std::vector<ExploredPoint>& explored, const std::string& profile,
                             std::optional<double> ExploredPoint::*by) {
  const ExploredPoint* best = nullptr;
  for (const ExploredPoint& point : explored)
    if (point.profile == profile && point.*by && (best == nullptr || *(point.*by) < *(best->*by)))
      best = &point;
  return best;
}

}  // namespace leviosim::tools
