#include <Eigen/Dense>

#include "numeric/linear_algebra/dense.hpp"

namespace bodesmith {
namespace {

/// R of A = Q R, as good as A itself for singular values, and far smaller; A has no fewer rows than columns.
Eigen::MatrixXd triangle_of(const Eigen::MatrixXd& a) {
  return a.householderQr().matrixQR().topRows(a.cols()).triangularView<Eigen::Upper>();
}

/// Without Eigen's own ways to make a matrix square, which take seconds to compile.
using JacobiSvd = Eigen::JacobiSVD<Eigen::MatrixXd, Eigen::NoQRPreconditioner>;

}  // namespace

Eigen::MatrixXd orthonormal_columns(const Eigen::MatrixXd& a) {
  return a.householderQr().householderQ() * Eigen::MatrixXd::Identity(a.rows(), a.cols());
}

Eigen::MatrixXd least_norm_columns(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.completeOrthogonalDecomposition().solve(b);
}

SquareSvd square_svd(const Eigen::MatrixXd& a) {
  const JacobiSvd svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return {svd.matrixU(), svd.singularValues(), svd.matrixV()};
}

Eigen::VectorXd singular_values(const Eigen::MatrixXd& a) {
  return JacobiSvd(a.rows() < a.cols() ? triangle_of(a.transpose()) : triangle_of(a)).singularValues();
}

Eigen::VectorXd smallest_singular_vector(const Eigen::MatrixXd& a) {
  return JacobiSvd(triangle_of(a), Eigen::ComputeFullV).matrixV().col(a.cols() - 1);
}

SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& a) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(a);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& a) {
  if (a.size() == 0) return {};
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(a, false);
  if (solver.info() != Eigen::Success) return {};
  return solver.eigenvalues();
}

std::optional<EigenSystem> eigen_system(const Eigen::MatrixXd& a) {
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(a);
  if (solver.info() != Eigen::Success) return std::nullopt;
  return EigenSystem{solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace bodesmith
