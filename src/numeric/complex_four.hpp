#pragma once

#include "numeric/four.hpp"

namespace bodesmith {

/// Four complex numbers side by side, real and imaginary parts apart. All of it is inlined: into a function that has clones
/// for wide vectors it comes with theirs.
struct ComplexFour {
  Four re, im;
};

[[gnu::always_inline]] inline ComplexFour four_at(const double* re, const double* im) {
  return {*four_at(re), *four_at(im)};
}
[[gnu::always_inline]] inline void put(const ComplexFour& x, double* re, double* im) {
  *four_at(re) = x.re;
  *four_at(im) = x.im;
}

[[gnu::always_inline]] inline ComplexFour operator*(const ComplexFour& a, const ComplexFour& b) {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
[[gnu::always_inline]] inline ComplexFour operator*(const ComplexFour& a, double b) {
  return {a.re * b, a.im * b};
}
/// conj(x)/|x|^2.
[[gnu::always_inline]] inline ComplexFour inverse(const ComplexFour& x) {
  const Four norm = x.re * x.re + x.im * x.im;
  return {x.re / norm, -x.im / norm};
}

}  // namespace bodesmith
