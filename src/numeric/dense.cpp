#include "numeric/dense.hpp"

#include <Eigen/Dense>

namespace bodesmith {

Eigen::MatrixXd gram(const Eigen::MatrixXd& a) {
  return a.transpose() * a;
}

Eigen::VectorXd transpose_times(const Eigen::MatrixXd& a, const Eigen::VectorXd& v) {
  return a.transpose() * v;
}

Eigen::VectorXd times(const Eigen::MatrixXd& a, const Eigen::VectorXd& v) {
  return a * v;
}

Eigen::MatrixXd times(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a * b;
}

Eigen::VectorXd solve_ldlt(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  return a.ldlt().solve(b);
}

Eigen::VectorXd solve_lu(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  return a.partialPivLu().solve(b);
}

Eigen::VectorXcd solve_lu(const Eigen::MatrixXcd& a, const Eigen::VectorXcd& b) {
  return a.partialPivLu().solve(b);
}

Eigen::VectorXd solve_qr(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  return a.colPivHouseholderQr().solve(b);
}

Eigen::VectorXd singular_values(const Eigen::MatrixXd& a) {
  return Eigen::JacobiSVD<Eigen::MatrixXd>(a).singularValues();
}

SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& a) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(a);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& a) {
  return Eigen::EigenSolver<Eigen::MatrixXd>(a, false).eigenvalues();
}

}  // namespace bodesmith
