#include "numeric/complex_lu.hpp"

#include <cmath>
#include <numeric>
#include <utility>

namespace bodesmith {

ComplexLu::ComplexLu(std::vector<Complex> rows, std::size_t n) : rows_(std::move(rows)), n_(n), order_(n) {
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  for (std::size_t k = 0; k < n_; ++k) {
    std::size_t best = k;
    for (std::size_t i = k + 1; i < n_; ++i) {
      if (std::norm(at(i, k)) > std::norm(at(best, k))) best = i;
    }
    const double size = std::norm(at(best, k));
    if (!(size > 0.0) || !std::isfinite(size)) {
      singular_ = true;
      determinant_ = 0.0;
      return;
    }
    if (best != k) {
      for (std::size_t c = 0; c < n_; ++c) std::swap(at(best, c), at(k, c));
      std::swap(order_[best], order_[k]);
      determinant_ = -determinant_;
    }
    determinant_ *= at(k, k);
    const Complex inverse = 1.0 / at(k, k);
    for (std::size_t i = k + 1; i < n_; ++i) {
      if (at(i, k) == 0.0) continue;
      const Complex factor = at(i, k) * inverse;
      at(i, k) = factor;
      for (std::size_t c = k + 1; c < n_; ++c) at(i, c) -= factor * at(k, c);
    }
  }
}

std::vector<ComplexLu::Complex> ComplexLu::solve(std::vector<Complex> b) const {
  std::vector<Complex> x(n_);
  for (std::size_t i = 0; i < n_; ++i) {
    x[i] = b[order_[i]];
    for (std::size_t c = 0; c < i; ++c) x[i] -= at(i, c) * x[c];
  }
  for (std::size_t i = n_; i-- > 0;) {
    for (std::size_t c = i + 1; c < n_; ++c) x[i] -= at(i, c) * x[c];
    x[i] /= at(i, i);
  }
  return x;
}

}  // namespace bodesmith
