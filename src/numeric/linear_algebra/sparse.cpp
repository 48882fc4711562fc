#include "numeric/linear_algebra/sparse.hpp"

#include <limits>
#include <utility>

#include "numeric/linear_algebra/sparse_lu.hpp"

namespace bodesmith {

void SparseSystem::transpose() {
  for (Entry& e : a) std::swap(e.row, e.column);
}

Eigen::MatrixXcd SparseSystem::dense() const {
  Eigen::MatrixXcd out = Eigen::MatrixXcd::Zero(b.size(), b.size());
  for (const Entry& e : a) out(e.row, e.column) += e.value;
  return out;
}

Eigen::VectorXcd solve_sparse(const SparseSystem& system) {
  return solve_sparse(system, system.b);
}

Eigen::MatrixXcd solve_sparse(const SparseSystem& system, const Eigen::MatrixXcd& b) {
  const Eigen::Index n = system.b.size();
  std::vector<Eigen::Triplet<std::complex<double>, int>> entries;
  entries.reserve(system.a.size());
  for (const SparseSystem::Entry& e : system.a)
    entries.emplace_back(static_cast<int>(e.row), static_cast<int>(e.column), e.value);
  Eigen::SparseMatrix<std::complex<double>> a(n, n);
  a.setFromTriplets(entries.begin(), entries.end());
  SparseLu<std::complex<double>> lu;
  if (!lu.factorise(a))
    return Eigen::MatrixXcd::Constant(n, b.cols(), std::numeric_limits<double>::quiet_NaN());
  Eigen::MatrixXcd out(n, b.cols());
  for (Eigen::Index k = 0; k < b.cols(); ++k) out.col(k) = lu.solve(b.col(k));
  return out;
}

}  // namespace bodesmith
