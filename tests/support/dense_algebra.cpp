#include "tests/support/dense_algebra.h"

#include <Eigen/Dense>

namespace leviosim::tests {

using Eigen::MatrixXd, Eigen::VectorXd;

MatrixXd inverse(const MatrixXd& a) { return a.partialPivLu().inverse(); }

VectorXd solve(const MatrixXd& a, const VectorXd& b) { return a.partialPivLu().solve(b); }

VectorXd least_squares(const MatrixXd& a, const VectorXd& b) { return a.householderQr().solve(b); }

VectorXd singular_values(const MatrixXd& a) {
  return Eigen::JacobiSVD<MatrixXd>(a).singularValues();
}

SymmetricEigen symmetric_eigen(const MatrixXd& a) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(a);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

MatrixXd cholesky(const MatrixXd& a) { return a.llt().matrixL(); }

MatrixXd orthonormal_basis(const MatrixXd& a) { return a.householderQr().householderQ(); }

VectorXd null_vector(const MatrixXd& rows) {
  // The last column of Q of rowsᵀ = Q·R, which the columns of rowsᵀ do not reach.
  return MatrixXd(rows.transpose().householderQr().householderQ()).col(rows.cols() - 1);
}

}  // namespace leviosim::tests
