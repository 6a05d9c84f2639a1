#include "tools/app/study/explore/exploration.h"

#include <algorithm>

#include "sim/base/interruption.h"

namespace leviosim::tools {

std::vector<vio::Assignment> effective(const std::vector<vio::Assignment>& point,
                                       const std::string& profile) {
  const bool use_imu = vio::profile_named(profile, 1).use_imu;
  std::vector<vio::Assignment> set;
  for (const vio::Assignment& a : point)
    if (use_imu || !a.parameter->needs_imu) set.push_back(a);
  return set;
}

std::vector<Point> exploration_runs(const BatchPlan& plan, const ExplorationPoints& points) {
  const std::vector<std::string> names = sequence_names(plan);
  std::vector<Point> runs;
  std::size_t first_row = 0;
  for (const std::vector<vio::Assignment>& point : points)
    for (const std::string& profile : plan.profiles) {
      throw_if_interrupted();
      const std::vector<vio::Assignment> set = effective(point, profile);
      for (const Sequence& sequence : plan.sequences)
        for (const std::uint32_t seed : plan.seeds) {
          Point run = make_run(plan, sequence, profile, plan.sizes.front(), seed);
          run.request.workload.insert(run.request.workload.end(), set.begin(), set.end());
          run.row =
              first_row + static_cast<std::size_t>(
                              std::find(names.begin(), names.end(), sequence.name) - names.begin());
          runs.push_back(std::move(run));
        }
      first_row += names.size();
    }
  return runs;
}

std::size_t point_of_row(const BatchPlan& plan, std::size_t row) {
  return row / (plan.profiles.size() * sequence_names(plan).size());
}

std::vector<ExploredPoint> explored_points(const BatchPlan& plan, const ExplorationPoints& points,
                                           const std::vector<Point>& runs,
                                           const std::vector<RunOutcome>& outcomes) {
  using OfSequence = ExploredPoint::OfSequence;
  const std::vector<std::string> names = sequence_names(plan);
  const auto rows = by_row(runs, outcomes, points.size() * plan.profiles.size() * names.size());
  auto row = rows.begin();
  std::vector<ExploredPoint> explored;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (const std::string& profile : plan.profiles) {
      ExploredPoint point{i, profile, effective(points[i], profile), {}, {}, {}};
      for (const std::string& name : names) {
        point.sequences.push_back({name, spread_of(values_of(*row, &RunOutcome::ate_m)),
                                   spread_of(values_of(*row, &RunOutcome::relative_percent))});
        ++row;
      }
      point.mean_ate =
          mean_of(values_of(point.sequences, [](const OfSequence& s) { return s.ate.median; }));
      point.mean_relative = mean_of(
          values_of(point.sequences, [](const OfSequence& s) { return s.relative.median; }));
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
