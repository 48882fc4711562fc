#include "tuning/loop_limits.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/units.hpp"

namespace bodesmith::tuning {
namespace {

using Complex = std::complex<double>;

struct Worst {
  double phase_margin_deg = 180.0;
  double gain_margin_db = INFINITY;
  double distance = INFINITY;  ///< least |1 + L|
};

void cross(const Complex& a, const Complex& b, Worst& worst) {
  if ((std::norm(a) < 1.0) != (std::norm(b) < 1.0)) {
    const double before = std::log(std::norm(a));
    const double t = before / (before - std::log(std::norm(b)));
    const double phase = std::arg(-a) + t * std::arg(b / a);
    const double margin = std::abs(to_degrees(std::remainder(phase, 2.0 * std::numbers::pi)));
    worst.phase_margin_deg = std::min(worst.phase_margin_deg, margin);
  }
  if ((a.imag() < 0.0) != (b.imag() < 0.0)) {
    const double t = a.imag() / (a.imag() - b.imag());
    const double real = a.real() + t * (b.real() - a.real());
    if (real < 0.0) worst.gain_margin_db = std::min(worst.gain_margin_db, std::abs(to_decibel(-real)));
  }
}

/// By how much arg(1 + L) grows from the first sample to the last: the ends' difference, and a turn for each time that the
/// straight line between two samples crosses the real axis below -1, downwards.
double turns_of(std::span<const Complex> loop) {
  int crossings = 0;
  for (std::size_t i = 1; i < loop.size(); ++i) {
    const Complex& a = loop[i - 1];
    const Complex& b = loop[i];
    if ((a.imag() < 0.0) == (b.imag() < 0.0)) continue;
    const double t = a.imag() / (a.imag() - b.imag());
    if (a.real() + t * (b.real() - a.real()) < -1.0) crossings += b.imag() < 0.0 ? 1 : -1;
  }
  return std::arg(1.0 + loop.back()) - std::arg(1.0 + loop.front()) + 2.0 * std::numbers::pi * crossings;
}

}  // namespace

bool turns_are_stable(std::span<const Complex> loop, int integrators) {
  if (!(std::abs(loop.back()) < 1.0)) return false;
  // It comes from -90 degrees an integrator, and ends near 0.
  return std::abs(turns_of(loop) - 0.5 * std::numbers::pi * integrators) < 0.5 * std::numbers::pi;
}

double shortfall(std::span<const Complex> loop, int integrators, const LoopLimits& limits) {
  Worst worst;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    worst.distance = std::min(worst.distance, std::abs(1.0 + loop[i]));
    if (i > 0) cross(loop[i - 1], loop[i], worst);
  }
  const auto missing = [](double wanted, double got) { return std::max(0.0, (wanted - got) / wanted); };
  double out = missing(limits.phase_margin_deg, worst.phase_margin_deg) +
               missing(limits.gain_margin_db, worst.gain_margin_db);
  if (limits.max_sensitivity) out += missing(1.0 / *limits.max_sensitivity, worst.distance);
  if (!turns_are_stable(loop, integrators)) out += 2.0;
  return out;
}

}  // namespace bodesmith::tuning
