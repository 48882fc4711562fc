#include "numeric/linear_algebra/sparse_lu.hpp"

#include <suitesparse/klu.h>

#include <complex>

namespace bodesmith {

template <class Value>
struct SparseLu<Value>::Implementation {
  static constexpr bool kReal = std::is_same_v<Value, double>;

  Implementation() {
    klu_defaults(&common);
    common.tol =
        1.0;  // the largest entry is the pivot: a diagonal a thousandth of it, KLU's own choice, costs digits
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;
  ~Implementation() {
    forget();
    klu_free_symbolic(&symbolic, &common);
  }

  void forget() {
    if constexpr (kReal) {
      klu_free_numeric(&factors, &common);
    } else {
      klu_z_free_numeric(&factors, &common);
    }
  }

  // KLU's interface is C without const: it changes none of what it is given to factorise.
  void factorise(const Eigen::SparseMatrix<Value>& a) {
    auto* begins = const_cast<int*>(a.outerIndexPtr());
    auto* rows = const_cast<int*>(a.innerIndexPtr());
    auto* values = reinterpret_cast<double*>(const_cast<Value*>(a.valuePtr()));
    if (symbolic == nullptr) symbolic = klu_analyze(static_cast<int>(a.cols()), begins, rows, &common);
    if (symbolic == nullptr) return;
    if constexpr (kReal) {
      factors = klu_factor(begins, rows, values, symbolic, &common);
    } else {
      factors = klu_z_factor(begins, rows, values, symbolic, &common);
    }
  }

  klu_common common{};
  klu_symbolic* symbolic = nullptr;
  klu_numeric* factors = nullptr;
};

template <class Value>
SparseLu<Value>::SparseLu() : implementation_(std::make_unique<Implementation>()) {}
template <class Value>
SparseLu<Value>::~SparseLu() = default;

template <class Value>
bool SparseLu<Value>::factorise(const Eigen::SparseMatrix<Value>& a) {
  implementation_->forget();
  implementation_->factorise(a);
  return implementation_->factors != nullptr && implementation_->common.status == KLU_OK;
}

template <class Value>
typename SparseLu<Value>::Vector SparseLu<Value>::solve(const Vector& b) const {
  Implementation& it = *implementation_;
  Vector x = b;
  auto* values = reinterpret_cast<double*>(x.data());
  const int n = static_cast<int>(b.size());
  if constexpr (Implementation::kReal) {
    klu_solve(it.symbolic, it.factors, n, 1, values, &it.common);
  } else {
    klu_z_solve(it.symbolic, it.factors, n, 1, values, &it.common);
  }
  return x;
}

template class SparseLu<double>;
template class SparseLu<std::complex<double>>;

}  // namespace bodesmith
