// Vectors and quaternions from the rows of tables of sensors and poses, within bounds.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <filesystem>

#include "sim/base/csv.h"

namespace leviosim::traces {

/// The largest magnitude of a kind of quantity.
struct Bound {
  double most;
  const char* what;
};
// The fastest gyroscopes end at 70 rad/s and shock sensors at 2000 m/s². Positions of 1e7 m span
// the Earth. Squares and integrals of such values stay numbers in single precision, too.
constexpr Bound kGyroBound{1e3, "any gyroscope [rad/s]"};
constexpr Bound kAccelBound{1e4, "any accelerometer [m/s^2]"};
constexpr Bound kPositionBound{1e7, "any flight [m]"};
constexpr Bound kVelocityBound{1e5, "any flight [m/s]"};

/// Three columns from `column` on. Throws InputError (file, line, column) beyond the bound.
Eigen::Vector3d vector_at(const base::CsvRow& row, std::size_t column, const Bound& bound);

/// Of four columns from `first` on, w first or last. Throws InputError unless its norm is 1 within
/// 1e-3.
enum class QuaternionOrder { wxyz, xyzw };
Eigen::Quaterniond quaternion_at(const base::CsvRow& row, std::size_t first,
                                 QuaternionOrder order = QuaternionOrder::wxyz);

/// Throws InputError for a file without a row.
void require_rows(std::size_t rows, const std::filesystem::path& file);

}  // namespace leviosim::traces
