#include "tools/sweep/sampling.h"

#include <fmt/core.h>

#include <numeric>
#include <utility>

#include "traces/rng.h"

namespace leviosim::tools {
namespace {

using Kind = SweepMember::Kind;

void check_count(std::size_t a, std::size_t b, const platform::Place& place) {
  if (b != 0 && a > kMostPoints / b)
    place.fail(fmt::format("gives more than {} points; expected fewer values", kMostPoints));
}

/// Each of `a` with each of `b`.
std::vector<SweepRow> product(const std::vector<SweepRow>& a, const std::vector<SweepRow>& b,
                              const platform::Place& place) {
  check_count(a.size(), b.size(), place);
  std::vector<SweepRow> rows;
  rows.reserve(a.size() * b.size());
  for (const SweepRow& x : a)
    for (const SweepRow& y : b) {
      rows.push_back(x);
      rows.back().insert(y.begin(), y.end());
    }
  return rows;
}

std::vector<SweepRow> grid(const SweepMember& member) {
  std::vector<SweepRow> rows{{}};
  for (const SweepAxis& axis : member.axes) {
    std::vector<SweepRow> values;
    for (const std::string& value : axis.domain.values) values.push_back({{axis.key.name, value}});
    rows = product(rows, values, member.place);
  }
  return rows;
}

std::vector<SweepRow> drawn(const SweepMember& member,
                            const std::vector<std::vector<double>>& cube) {
  std::vector<SweepRow> rows(cube.size());
  for (std::size_t i = 0; i < cube.size(); ++i)
    for (std::size_t d = 0; d < member.axes.size(); ++d)
      rows[i][member.axes[d].key.name] = value_at(member.axes[d].domain, cube[i][d]);
  return rows;
}

std::vector<SweepRow> rows_of(const SweepMember& member) {
  switch (member.kind) {
    case Kind::grid:
      return grid(member);
    case Kind::list:
      return member.rows;
    case Kind::random:
      return drawn(member, random_cube(member.count, member.axes.size(), member.seed));
    case Kind::latin_hypercube:
      return drawn(member, latin_hypercube(member.count, member.axes.size(), member.seed));
  }
  return {};
}

}  // namespace

std::vector<std::vector<double>> random_cube(std::size_t count, std::size_t dimensions,
                                             std::uint64_t seed) {
  std::vector<std::vector<double>> points(count, std::vector<double>(dimensions));
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t d = 0; d < dimensions; ++d)
      points[i][d] = traces::Rng(traces::derive_seed(traces::derive_seed(seed, i), d)).uniform();
  return points;
}

std::vector<std::vector<double>> latin_hypercube(std::size_t count, std::size_t dimensions,
                                                 std::uint64_t seed) {
  constexpr double kInside = 1 - 1e-9;  // rounding must not lift a point into the next stratum
  std::vector<std::vector<double>> points(count, std::vector<double>(dimensions));
  std::vector<std::size_t> strata(count);
  for (std::size_t d = 0; d < dimensions; ++d) {
    traces::Rng rng(traces::derive_seed(seed, d));
    std::iota(strata.begin(), strata.end(), std::size_t{0});
    for (std::size_t i = count; i > 1; --i)  // Fisher and Yates
      std::swap(strata[i - 1], strata[static_cast<std::size_t>(rng.below(static_cast<int>(i)))]);
    for (std::size_t i = 0; i < count; ++i)
      points[i][d] =
          (static_cast<double>(strata[i]) + kInside * rng.uniform()) / static_cast<double>(count);
  }
  return points;
}

std::vector<SweepRow> rows_of(const SweepGroup& group) {
  std::vector<SweepRow> rows{{}};
  for (const SweepMember& member : group.members)
    rows = product(rows, rows_of(member), group.place);
  return rows;
}

}  // namespace leviosim::tools
