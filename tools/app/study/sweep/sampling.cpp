#include "tools/app/study/sweep/sampling.h"

#include <fmt/core.h>

#include <numeric>
#include <utility>

#include "sim/base/interruption.h"
#include "traces/datasets/rng.h"

namespace leviosim::tools {
namespace {

using MemberKind = SweepMember::Kind;

/// @throws InputError at `place` for too many
std::size_t multiplied(std::size_t a, std::size_t b, const platform::Place& place) {
  if (b != 0 && a > kMostPoints / b)
    place.fail(fmt::format("gives more than {} points; expected fewer values", kMostPoints));
  return a * b;
}

std::size_t count_of(const SweepMember& member) {
  if (member.kind == MemberKind::list) return member.rows.size();
  if (member.kind != MemberKind::grid) return member.count;
  std::size_t rows = 1;
  for (const SweepAxis& axis : member.axes)
    rows = multiplied(rows, axis.domain.values.size(), member.place);
  return rows;
}

std::vector<SweepRow> drawn_rows(const SweepMember& member) {
  std::vector<SweepRow> rows(member.count);
  for (std::size_t d = 0; d < member.axes.size(); ++d) {
    const SweepAxis& axis = member.axes[d];
    const std::vector<double> draws = member.kind == MemberKind::random
                                          ? random_draws(member.count, d, member.seed)
                                          : latin_draws(member.count, d, member.seed);
    throw_if_interrupted();
    for (std::size_t i = 0; i < member.count; ++i)
      rows[i][axis.key.name] = value_at(axis.domain, draws[i]);
  }
  return rows;
}

/// Every one of `rows` with every one of `others`, which vary faster.
std::vector<SweepRow> product(const std::vector<SweepRow>& rows,
                              const std::vector<SweepRow>& others) {
  std::vector<SweepRow> all;
  for (const SweepRow& row : rows) {
    throw_if_interrupted();
    for (const SweepRow& other : others) all.emplace_back(row).insert(other.begin(), other.end());
  }
  return all;
}

std::vector<SweepRow> rows_of(const SweepMember& member) {
  if (member.kind == MemberKind::list) return member.rows;
  if (member.kind != MemberKind::grid) return drawn_rows(member);
  std::vector<SweepRow> rows(1);
  for (const SweepAxis& axis : member.axes) {
    std::vector<SweepRow> values;
    for (const std::string& value : axis.domain.values) values.push_back({{axis.key.name, value}});
    rows = product(rows, values);
  }
  return rows;
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

std::vector<SweepRow> rows_of(const SweepGroup& group) {
  std::size_t count = 1;  // refused before any is made
  for (const SweepMember& member : group.members)
    count = multiplied(count, count_of(member), group.place);
  std::vector<SweepRow> rows(1);
  for (const SweepMember& member : group.members) rows = product(rows, rows_of(member));
  return rows;
}

}  // namespace leviosim::tools
