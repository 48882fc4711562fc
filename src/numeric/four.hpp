#pragma once

// One source for processors with and without wide vectors; chosen when the program starts, by what the processor has (a name
// of a processor, "arch=…", would leave out all makers but one). No fused multiplication and addition: every processor gives
// the same bits. Sanitizers instrument before that choice is made, so they get the plain one.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define BODESMITH_CLONES __attribute__((target_clones("default", "avx2")))
#else
#define BODESMITH_CLONES
#endif

namespace bodesmith {

/// Four numbers side by side, wherever they lie: one instruction on processors with wide vectors, two on others, the same bits.
using Four __attribute__((vector_size(32), aligned(8), may_alias)) = double;

inline const Four* four_at(const double* from) {
  return reinterpret_cast<const Four*>(from);
}
inline Four* four_at(double* to) {
  return reinterpret_cast<Four*>(to);
}

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
