#include "numeric/sparse.hpp"

#include <Eigen/SparseLU>
#include <algorithm>
#include <limits>
#include <utility>

#include "numeric/dense.hpp"

namespace bodesmith {

namespace {

constexpr Eigen::Index kDenseUpTo = 100;

Eigen::VectorXcd solve_as_dense(const SparseSystem& system) {
  return solve_lu(system.dense(), system.b);
}

}  // namespace

void SparseSystem::clear_row(Eigen::Index row) {
  a.erase(std::remove_if(a.begin(), a.end(), [row](const Entry& e) { return e.row == row; }), a.end());
}

void SparseSystem::transpose() {
  for (Entry& e : a) std::swap(e.row, e.column);
}

Eigen::MatrixXcd SparseSystem::dense() const {
  Eigen::MatrixXcd out = Eigen::MatrixXcd::Zero(b.size(), b.size());
  for (const Entry& e : a) out(e.row, e.column) += e.value;
  return out;
}

Eigen::VectorXcd solve_sparse(const SparseSystem& system) {
  const Eigen::Index n = system.b.size();
  if (n <= kDenseUpTo) return solve_as_dense(system);
  std::vector<Eigen::Triplet<std::complex<double>, int>> entries;
  entries.reserve(system.a.size());
  for (const SparseSystem::Entry& e : system.a)
    entries.emplace_back(static_cast<int>(e.row), static_cast<int>(e.column), e.value);
  Eigen::SparseMatrix<std::complex<double>> a(n, n);
  a.setFromTriplets(entries.begin(), entries.end());
  Eigen::SparseLU<Eigen::SparseMatrix<std::complex<double>>, Eigen::COLAMDOrdering<int>> lu;
  lu.compute(a);
  if (lu.info() != Eigen::Success)
    return Eigen::VectorXcd::Constant(n, std::numeric_limits<double>::quiet_NaN());
  return lu.solve(system.b);
}

}  // namespace bodesmith
