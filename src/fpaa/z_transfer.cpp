#include "fpaa/z_transfer.hpp"

#include <cmath>
#include <limits>

namespace bodesmith::fpaa {
namespace {

std::complex<double> polynomial(const std::vector<double>& coefficients, std::complex<double> z_inverse) {
  std::complex<double> sum = 0.0;
  for (auto c = coefficients.rbegin(); c != coefficients.rend(); ++c) sum = sum * z_inverse + *c;
  return sum;
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

bool ZTransfer::is_stable() const {
  std::vector<double> a = denominator;
  while (a.size() > 1 && a.back() == 0.0) a.pop_back();
  // Schur-Cohn: reduce the degree as long as the reflection coefficient is inside the unit circle.
  while (a.size() > 1) {
    const double reflection = a.back() / a.front();
    if (!(std::abs(reflection) < 1.0)) return false;
    std::vector<double> next(a.size() - 1);
    for (size_t i = 0; i + 1 < a.size(); ++i) next[i] = a[i] - reflection * a[a.size() - 1 - i];
    a = std::move(next);
  }
  return a.front() != 0.0;
}

std::complex<double> zero_order_hold(RadPerSecond w, Hertz clock) {
  const double half = 0.5 * w.value / clock.value;
  const double sinc = std::abs(half) < 1e-8 ? 1.0 : std::sin(half) / half;
  return std::polar(1.0, -half) * sinc;
}

std::complex<double> cycle_delay(RadPerSecond w, Hertz clock, double cycles) {
  return std::polar(1.0, -w.value * cycles / clock.value);
}

}  // namespace bodesmith::fpaa
