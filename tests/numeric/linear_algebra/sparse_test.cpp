#include "numeric/linear_algebra/sparse.hpp"

#include <gtest/gtest.h>

#include <random>

#include "numeric/linear_algebra/sparse_lu.hpp"

namespace bodesmith {
namespace {

/// A ring of n unknowns with a few far couplings.
SparseSystem ring(Eigen::Index n) {
  std::mt19937_64 random(3);
  const auto any = [&] { return static_cast<double>(random() % 2001) / 1000.0 - 1.0; };
  SparseSystem out{{}, Eigen::VectorXcd::Zero(n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    out.b(i) = {any(), any()};
    out.add(i, i, 3.0);
    out.add(i, i, {0.0, any()});  // adds up with the one before
    out.add(i, (i + 1) % n, {any(), any()});
    out.add((i * 7) % n, i, any());
  }
  return out;
}

Eigen::VectorXcd residual(const SparseSystem& system, const Eigen::VectorXcd& x) {
  Eigen::VectorXcd out = -system.b;
  for (const auto& e : system.a) out(e.row) += e.value * x(e.column);
  return out;
}

TEST(Sparse, SmallAndLargeSystemsAreSolved) {
  for (const Eigen::Index n : {3, 100, 101, 1500}) {
    const SparseSystem system = ring(n);
    EXPECT_LT(residual(system, solve_sparse(system)).norm(), 1e-8) << n;
  }
}

TEST(Sparse, TheTransposeIsAnotherSystem) {
  SparseSystem system = ring(150);
  const Eigen::MatrixXcd before = system.dense();
  system.transpose();
  EXPECT_EQ(system.dense(), before.transpose());
  EXPECT_LT(residual(system, solve_sparse(system)).norm(), 1e-8);
}

TEST(Sparse, WhatHasNoSolutionIsNotFinite) {
  SparseSystem system = ring(120);
  std::erase_if(system.a, [](const SparseSystem::Entry& entry) { return entry.row == 7; });
  EXPECT_FALSE(solve_sparse(system).allFinite());
}

TEST(SparseLu, OnePatternIsFactorisedAgainAndAgain) {
  Eigen::SparseMatrix<double> a(3, 3);
  for (const auto& [row, column] : {std::pair(0, 0), {0, 2}, {1, 1}, {2, 0}, {2, 1}})
    a.insert(row, column) = row + column + 1.0;
  a.makeCompressed();
  SparseLu<double> lu;
  for (const double factor : {1.0, -3.0}) {
    a *= factor;
    ASSERT_TRUE(lu.factorise(a));
    const Eigen::Vector3d b(1.0, 2.0, 3.0);
    EXPECT_LT((a * lu.solve(b) - b).norm(), 1e-14);
  }
  a.coeffRef(0, 2) = 0.0;  // the last column is empty
  EXPECT_FALSE(lu.factorise(a));
}

}  // namespace
}  // namespace bodesmith
