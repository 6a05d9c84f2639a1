// Decompositions of dense matrices by Eigen, as references for kernels. They are compiled once, as
// each takes seconds.
#pragma once

#include <Eigen/Core>

namespace leviosim::tests {

/// Of a square matrix that has an inverse.
Eigen::MatrixXd inverse(const Eigen::MatrixXd& a);

/// x of a·x = b, for a square matrix that has an inverse.
Eigen::VectorXd solve(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

/// The x for which |a·x − b| is least; at least as many rows as columns.
Eigen::VectorXd least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

/// In decreasing order.
Eigen::VectorXd singular_values(const Eigen::MatrixXd& a);

struct SymmetricEigen {
  Eigen::VectorXd values;   ///< in increasing order
  Eigen::MatrixXd vectors;  ///< in columns
};
/// Of a symmetric matrix, whose lower triangle is read.
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& a);

/// L of a = L·Lᵀ, for a positive definite matrix.
Eigen::MatrixXd cholesky(const Eigen::MatrixXd& a);

/// An orthonormal basis whose first columns span those of a square matrix.
Eigen::MatrixXd orthonormal_basis(const Eigen::MatrixXd& a);

/// The unit vector to which all rows are orthogonal; one row less than columns.
Eigen::VectorXd null_vector(const Eigen::MatrixXd& rows);

}  // namespace leviosim::tests
