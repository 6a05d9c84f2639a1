#include "tools/app/study/sweep/sampling.h"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "sim/base/check.h"
#include "sim/base/interruption.h"
#include "traces/datasets/rng.h"

namespace leviosim::tools {
namespace {

using MemberKind = SweepMember::Kind;

constexpr std::size_t kRowsPerPoll = 1024;

/// @throws InputError at `place` for too many
std::size_t multiplied(std::size_t a, std::size_t b, const platform::Place& place) {
  if (b != 0 && a > kMostPoints / b)
    place.fail(fmt::format("gives more than {} points; expected fewer values", kMostPoints));
  return a * b;
}

std::size_t rows_of(const SweepMember& member) {
  if (member.kind == MemberKind::list) return member.rows.size();
  if (member.kind != MemberKind::grid) return member.count;
  std::size_t rows = 1;
  for (const SweepAxis& axis : member.axes)
    rows = multiplied(rows, axis.domain.values.size(), member.place);
  return rows;
}

std::size_t place_of(const SweepPlan& plan, const SweepKey& key) {
  const auto it = std::find_if(plan.keys.begin(), plan.keys.end(),
                               [&](const SweepKey& k) { return k.name == key.name; });
  check(it != plan.keys.end(), "the key of an axis is one of the plan");
  return static_cast<std::size_t>(it - plan.keys.begin());
}

}  // namespace

std::vector<double> random_draws(std::size_t count, std::size_t dimension, std::uint64_t seed) {
  std::vector<double> draws(count);
  for (std::size_t i = 0; i < count; ++i)
    draws[i] = traces::Rng(traces::derive_seed(traces::derive_seed(seed, i), dimension)).uniform();
  return draws;
}

std::vector<double> latin_draws(std::size_t count, std::size_t dimension, std::uint64_t seed) {
  constexpr double kInside = 1 - 1e-9;  // rounding must not lift a point into the next stratum
  std::vector<double> draws(count);
  std::vector<std::uint32_t> strata(count);
  traces::Rng rng(traces::derive_seed(seed, dimension));
  std::iota(strata.begin(), strata.end(), 0u);
  for (std::size_t i = count; i > 1; --i)  // Fisher and Yates
    std::swap(strata[i - 1], strata[static_cast<std::size_t>(rng.below(static_cast<int>(i)))]);
  for (std::size_t i = 0; i < count; ++i)
    draws[i] =
        (static_cast<double>(strata[i]) + kInside * rng.uniform()) / static_cast<double>(count);
  return draws;
}

GroupRows::GroupRows(const SweepPlan& plan, const SweepGroup& group, ValuePool& pool) {
  std::size_t rows = 1;  // refused before any is made
  for (const SweepMember& member : group.members)
    rows = multiplied(rows, rows_of(member), group.place);
  for (auto member = group.members.rbegin(); member != group.members.rend(); ++member) {
    if (member->kind == MemberKind::grid)
      add_grid(plan, *member, pool);
    else if (member->kind == MemberKind::list)
      add_list(plan, *member, pool);
    else
      add_draws(plan, *member, pool);
  }
  check_equal(size_, rows, "rows of a group");
}

void GroupRows::add_grid(const SweepPlan& plan, const SweepMember& member, ValuePool& pool) {
  for (auto axis = member.axes.rbegin(); axis != member.axes.rend(); ++axis) {
    Column column{place_of(plan, axis->key), size_, {}};
    for (const std::string& value : axis->domain.values)
      column.ids.push_back(pool.add(column.key, value));
    size_ *= column.ids.size();
    columns_.push_back(std::move(column));
  }
}

void GroupRows::add_list(const SweepPlan& plan, const SweepMember& member, ValuePool& pool) {
  for (const SweepAxis& axis : member.axes) {
    Column column{place_of(plan, axis.key), size_, {}};
    for (const SweepRow& row : member.rows) {
      const auto set = row.find(axis.key.name);
      column.ids.push_back(set == row.end() ? kUnset : pool.add(column.key, set->second));
    }
    columns_.push_back(std::move(column));
  }
  size_ *= member.rows.size();
}

void GroupRows::add_draws(const SweepPlan& plan, const SweepMember& member, ValuePool& pool) {
  for (std::size_t d = 0; d < member.axes.size(); ++d) {
    const SweepAxis& axis = member.axes[d];
    const std::vector<double> draws = member.kind == MemberKind::random
                                          ? random_draws(member.count, d, member.seed)
                                          : latin_draws(member.count, d, member.seed);
    Column column{place_of(plan, axis.key), size_, std::vector<ValueId>(member.count)};
    for (std::size_t i = 0; i < member.count; ++i) {
      if (i % kRowsPerPoll == 0) throw_if_interrupted();
      column.ids[i] = pool.add(column.key, value_at(axis.domain, draws[i]));
    }
    columns_.push_back(std::move(column));
  }
  size_ *= member.count;
}

void GroupRows::put(std::size_t row, std::span<ValueId> values) const {
  for (const Column& column : columns_) {
    const ValueId id = column.ids[row / column.stride % column.ids.size()];
    if (id != kUnset) values[column.key] = id;
  }
}

}  // namespace leviosim::tools
