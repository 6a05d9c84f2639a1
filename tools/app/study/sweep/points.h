// A plan expanded: every point checked, each different one once. A point is kept as the number of
// its row; the rest is made when it is asked for.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "tools/app/study/sweep/point_family.h"
#include "tools/app/study/sweep/sampling.h"

namespace leviosim::tools {

/// What a sweep keeps of a point, for point_key().
inline constexpr std::string_view kSweepFigures = "figures of a sweep";

struct SweepPoint {
  int number = 0;                          ///< from 1
  SweepRow settings;                       ///< with those of the base
  std::vector<PointParameter> parameters;  ///< in the order of SweepPlan::keys
  std::string key;                         ///< point_key()
};

/// The points of a sweep, as their numbers less 1. Several threads may read.
class SweepPoints {
 public:
  explicit SweepPoints(const SweepPlan& plan);

  std::size_t size() const { return rows_.size(); }
  SweepPoint operator[](std::size_t i) const;
  /// point_key(): a digest of some 10 kB.
  std::string key(std::size_t i) const;
  SweepRow settings(std::size_t i) const;
  /// "platform.cluster.clock=240MHz workload.window=6", in the order of SweepPlan::keys.
  std::string settings_text(std::size_t i) const;

 private:
  friend class Expander;
  /// Of a row, counted over all groups: one per key of the plan.
  std::vector<ValueId> values_of(std::size_t row) const;
  void put_values(std::size_t row, std::span<ValueId> values) const;
  const PointFamily& family_of(std::span<const ValueId> values) const;
  SweepRow settings_of(std::span<const ValueId> values) const;

  const SweepPlan* plan_;
  std::unique_ptr<ValuePool> pool_;
  std::vector<GroupRows> groups_;
  std::vector<std::size_t> first_rows_;  ///< of the groups
  std::vector<ValueId> base_;            ///< what the base sets of the groups' keys
  std::map<std::vector<ValueId>, std::unique_ptr<PointFamily>> families_;  ///< by identifier
  std::vector<std::uint32_t> rows_;                                        ///< of the points
};

struct Expansion {
  SweepPoints points;
  std::size_t asked = 0;           ///< points of the plan, repetitions included
  std::size_t impossible = 0;      ///< points that were left out, if the plan says skip
  std::string first_impossible{};  ///< why the first was
};

/// @param plan  outlives the points
/// @throws InputError for points that cannot be, Interrupted
Expansion expand(const SweepPlan& plan, SweepInputs& inputs);

}  // namespace leviosim::tools
