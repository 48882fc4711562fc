#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

namespace bodesmith {

/// A x = b with few entries in each row; entries at one place add up.
struct SparseSystem {
  struct Entry {
    Eigen::Index row = 0;
    Eigen::Index column = 0;
    std::complex<double> value;
  };
  std::vector<Entry> a;
  Eigen::VectorXcd b;  ///< its size is that of A

  void add(Eigen::Index row, Eigen::Index column, std::complex<double> value) {
    a.push_back({row, column, value});
  }
  void transpose();
  Eigen::MatrixXcd dense() const;
};

/// x, by SparseLu. A singular system gives numbers that are not finite.
Eigen::VectorXcd solve_sparse(const SparseSystem& system);
/// The same for each column of b.
Eigen::MatrixXcd solve_sparse(const SparseSystem& system, const Eigen::MatrixXcd& b);

}  // namespace bodesmith
