#pragma once

#include <Eigen/SparseCore>
#include <memory>
#include <type_traits>

namespace bodesmith {

/// A = L U for sparse matrices of one pattern, by KLU (block triangular form, approximate minimum degree, rows scaled by
/// their largest entry): Davis, Palamadai Natarajan, "Algorithm 907: KLU, a direct sparse solver for circuit simulation
/// problems", ACM Trans. Math. Softw. 37(3), 2010. Value: double or std::complex<double>.
template <class Value>
class SparseLu {
  static_assert(std::is_same_v<Value, double> || std::is_same_v<Value, std::complex<double>>);

 public:
  using Vector = Eigen::Matrix<Value, Eigen::Dynamic, 1>;

  SparseLu();
  ~SparseLu();

  /// The pattern is analysed the first time, and is that of every later `a`. False where A is singular or not finite.
  bool factorise(const Eigen::SparseMatrix<Value>& a);
  /// x of A x = b for the A last factorised with success.
  Vector solve(const Vector& b) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

extern template class SparseLu<double>;
extern template class SparseLu<std::complex<double>>;

}  // namespace bodesmith
