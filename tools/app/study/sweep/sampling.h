// The points of a group of a plan, in an order that depends on nothing but the plan. Rows are not
// made: what a row sets is looked up in a column per key.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tools/app/study/sweep/plan.h"
#include "tools/app/study/sweep/value_pool.h"

namespace leviosim::tools {

/// A sweep has no more points than this.
inline constexpr std::size_t kMostPoints = 1'000'000;

/// One dimension of `count` points of the unit cube, drawn evenly, in [0, 1). A point does not
/// depend on how many there are.
std::vector<double> random_draws(std::size_t count, std::size_t dimension, std::uint64_t seed);

/// One dimension of a Latin hypercube (McKay, Beckman and Conover, Technometrics 21(2), 1979): if
/// it is cut into `count` equal strata, every stratum holds exactly one point.
std::vector<double> latin_draws(std::size_t count, std::size_t dimension, std::uint64_t seed);

class GroupRows {
 public:
  /// @param pool  gets the values
  /// @throws InputError for more than kMostPoints, Interrupted
  GroupRows(const SweepPlan& plan, const SweepGroup& group, ValuePool& pool);

  /// The last key of a grid and the last member vary fastest.
  std::size_t size() const { return size_; }
  /// Writes the values of the keys that the row sets. @param values  one per key of the plan
  void put(std::size_t row, std::span<ValueId> values) const;

 private:
  /// Row r has the value ids[r / stride % ids.size()].
  struct Column {
    std::size_t key;
    std::size_t stride;
    std::vector<ValueId> ids;
  };
  void add_grid(const SweepPlan& plan, const SweepMember& member, ValuePool& pool);
  void add_list(const SweepPlan& plan, const SweepMember& member, ValuePool& pool);
  void add_draws(const SweepPlan& plan, const SweepMember& member, ValuePool& pool);

  std::vector<Column> columns_;
  std::size_t size_ = 1;
};

}  // namespace leviosim::tools
