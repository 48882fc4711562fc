#include "fpaa/cams/z_transfer.hpp"

#include <cmath>
#include <limits>

namespace bodesmith::fpaa {
namespace {

/// c0 + c1 x + c2 x^2 + ...
std::complex<double> polynomial(const std::vector<double>& coefficients, std::complex<double> x) {
  std::complex<double> sum = 0.0;
  for (auto c = coefficients.rbegin(); c != coefficients.rend(); ++c) sum = sum * x + *c;
  return sum;
}

/// A polynomial in 1 - x as one in x, by Horner's rule on polynomials.
std::vector<double> expanded(const std::vector<double>& in_one_minus_x) {
  std::vector<double> out;
  for (auto c = in_one_minus_x.rbegin(); c != in_one_minus_x.rend(); ++c) {
    // out (1 - x) + c
    out.push_back(0.0);
    for (std::size_t k = out.size() - 1; k > 0; --k) out[k] -= out[k - 1];
    out[0] += *c;
  }
  return out;
}

double sum(const std::vector<double>& values) {
  double total = 0.0;
  for (const double value : values) total += value;
  return total;
}

}  // namespace

std::complex<double> ZTransfer::response(RadPerSecond w, Hertz clock) const {
  const std::complex<double> z_inverse = std::polar(1.0, -w.value / clock.value);
  return polynomial(numerator, z_inverse) / polynomial(denominator, z_inverse);
}

double ZTransfer::dc_gain() const {
  const double bottom = sum(denominator);
  if (bottom == 0.0) return std::numeric_limits<double>::infinity();
  return sum(numerator) / bottom;
}

std::complex<double> DeltaTransfer::response(RadPerSecond w, Hertz clock) const {
  const std::complex<double> d = 1.0 - std::polar(1.0, -w.value / clock.value);
  return polynomial(numerator, d) / polynomial(denominator, d);
}

ZTransfer DeltaTransfer::in_z() const {
  return {expanded(numerator), expanded(denominator)};
}

DeltaTransfer in_delta(const ZTransfer& z) {
  // z^-k = (1 - D)^k: the same change of variable in either direction.
  const ZTransfer swapped = DeltaTransfer{z.numerator, z.denominator}.in_z();
  return {swapped.numerator, swapped.denominator};
}

}  // namespace bodesmith::fpaa
