#include "fpaa/cams/placed_cam.hpp"

#include <algorithm>
#include <limits>

namespace bodesmith::fpaa {
namespace {

/// c0 + c1 x + c2 x^2 + ...
Complex polynomial(const std::vector<double>& coefficients, Complex x) {
  Complex sum = 0.0;
  for (auto c = coefficients.rbegin(); c != coefficients.rend(); ++c) sum = sum * x + *c;
  return sum;
}

double sum(const std::vector<double>& values) {
  double total = 0.0;
  for (const double value : values) total += value;
  return total;
}

}  // namespace

Complex ZTransfer::response(RadPerSecond w, Hertz clock, std::size_t input) const {
  const Complex z_inverse = std::polar(1.0, -w.value / clock.value);
  return polynomial(numerators.at(input - 1), z_inverse) / polynomial(denominator, z_inverse);
}

double ZTransfer::dc_gain(std::size_t input) const {
  const double bottom = sum(denominator);
  if (bottom == 0.0) return std::numeric_limits<double>::infinity();
  return sum(numerators.at(input - 1)) / bottom;
}

std::vector<double> in_one_minus(const std::vector<double>& coefficients) {
  // By Horner's rule on polynomials.
  std::vector<double> out;
  for (auto c = coefficients.rbegin(); c != coefficients.rend(); ++c) {
    // out (1 - x) + c
    out.push_back(0.0);
    for (std::size_t k = out.size() - 1; k > 0; --k) out[k] -= out[k - 1];
    out[0] += *c;
  }
  return out;
}

CapacitorUnits::CapacitorUnits(std::span<const Capacitor> capacitors) : capacitors_(capacitors) {
  for (const Capacitor& c : capacitors) units_.push_back(c.units);
}

CapacitorUnits::CapacitorUnits(std::span<const Capacitor> capacitors, std::span<const double> units)
    : capacitors_(capacitors), units_(units.begin(), units.end()) {
  constexpr double kLeast = 1e-9;
  for (std::size_t i = 0; i < units_.size(); ++i) {
    if (capacitors[i].units > 0) units_[i] = std::max(units_[i], kLeast);
  }
}

double CapacitorUnits::operator[](std::string_view name) const {
  for (std::size_t i = 0; i < capacitors_.size(); ++i) {
    if (capacitors_[i].name == name) return units_[i];
  }
  return 0.0;
}

}  // namespace bodesmith::fpaa
