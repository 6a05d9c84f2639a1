#include "traces/datasets/row_values.h"

#include <fmt/core.h>

#include <cmath>

#include "sim/base/error.h"

namespace leviosim::traces {
namespace {

constexpr double kQuaternionTolerance = 1e-3;

}  // namespace

Eigen::Vector3d vector_at(const base::CsvRow& row, std::size_t column, const Bound& bound) {
  Eigen::Vector3d vector;
  for (int k = 0; k < 3; ++k) {
    const std::size_t at = column + static_cast<std::size_t>(k);
    vector[k] = row.number(at);
    if (std::abs(vector[k]) > bound.most)
      row.fail(at, fmt::format("beyond {}; expected from {} to {}", bound.what, -bound.most,
                               bound.most));
  }
  return vector;
}

Eigen::Quaterniond quaternion_at(const base::CsvRow& row, std::size_t first,
                                 QuaternionOrder order) {
  const std::size_t w = order == QuaternionOrder::wxyz ? first : first + 3;
  const std::size_t x = order == QuaternionOrder::wxyz ? first + 1 : first;
  const Eigen::Quaterniond q(row.number(w), row.number(x), row.number(x + 1), row.number(x + 2));
  if (std::abs(q.norm() - 1) > kQuaternionTolerance)
    row.fail(fmt::format("the quaternion has norm {:.6f} instead of 1", q.norm()));
  return q.normalized();
}

void require_rows(std::size_t rows, const std::filesystem::path& file) {
  if (rows == 0) throw InputError(fmt::format("{}: the sequence is empty (no row)", file.string()));
}

}  // namespace leviosim::traces
