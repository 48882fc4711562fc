#pragma once

#include <algorithm>
#include <complex>
#include <cstddef>

namespace bodesmith::fpaa {

/// Two doubles that every processor of this kind works on at once.
using Pair = double __attribute__((vector_size(16)));

/// Complex numbers at two points of a grid. The product is without the care for NaN and overflow that the one of std::complex
/// takes: everything here is of moderate size. Each of the two comes out as a single one would, to the last bit.
struct ComplexPair {
  Pair re, im;

  ComplexPair() = default;
  ComplexPair(double value) : re{value, value}, im{0.0, 0.0} {}
  ComplexPair(Pair real, Pair imaginary) : re(real), im(imaginary) {}
  ComplexPair(std::complex<double> a, std::complex<double> b)
      : re{a.real(), b.real()}, im{a.imag(), b.imag()} {}

  std::complex<double> at(std::size_t which) const { return {re[which], im[which]}; }
  ComplexPair& operator+=(const ComplexPair& by) { return *this = {re + by.re, im + by.im}; }
  ComplexPair& operator-=(const ComplexPair& by) { return *this = {re - by.re, im - by.im}; }
};

inline ComplexPair operator+(const ComplexPair& a, const ComplexPair& b) {
  return {a.re + b.re, a.im + b.im};
}
inline ComplexPair operator-(const ComplexPair& a, const ComplexPair& b) {
  return {a.re - b.re, a.im - b.im};
}
inline ComplexPair operator-(const ComplexPair& a) {
  return {-a.re, -a.im};
}
inline ComplexPair operator*(double by, const ComplexPair& a) {
  return {by * a.re, by * a.im};
}
inline ComplexPair operator/(const ComplexPair& a, double by) {
  return {a.re / by, a.im / by};
}
inline ComplexPair conj(const ComplexPair& a) {
  return {a.re, -a.im};
}
inline Pair norm(const ComplexPair& a) {
  return a.re * a.re + a.im * a.im;
}
/// Of the two.
inline double largest_abs(const ComplexPair& a) {
  return std::max(std::abs(a.at(0)), std::abs(a.at(1)));
}
inline ComplexPair product(const ComplexPair& a, const ComplexPair& b) {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
inline ComplexPair inverse(const ComplexPair& of) {
  const Pair by = 1.0 / norm(of);
  return {of.re * by, -of.im * by};
}
inline ComplexPair quotient(const ComplexPair& above, const ComplexPair& below) {
  return product(above, inverse(below));
}
inline std::complex<double> product(std::complex<double> a, std::complex<double> b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

}  // namespace bodesmith::fpaa
