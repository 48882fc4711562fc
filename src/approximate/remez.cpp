#include "approximate/remez.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "approximate/log_symmetric.hpp"
#include "numeric/elliptic_k.hpp"
#include "numeric/optimisation/bounded_least_squares.hpp"

namespace bodesmith {
namespace {

using Real = long double;
using ComplexReal = std::complex<Real>;

/// half_lead of a conjugate pair, and its derivatives.
Real pair_lead(Real v, ComplexReal z) {
  if (std::isinf(v)) return z.real();
  const Real far = std::log(std::abs(1.0L + std::exp(-(v + z))));
  if (v >= z.real()) return z.real() + far - std::log(std::abs(1.0L + std::exp(z - v)));
  return v + far - std::log(std::abs(1.0L + std::exp(v - z)));
}
ComplexReal pair_slope(Real v, ComplexReal z) {  // by the real part, and minus by the imaginary part
  if (std::isinf(v)) return 1.0L;
  const Real q = std::exp(-2.0L * v);
  return (1.0L - q) / (1.0L + q + std::exp(z - v) + std::exp(-z - v));
}
Real pair_slope_by_v(Real v, ComplexReal z) {
  return (std::sinh(z) / (std::cosh(v) + std::cosh(z))).real();
}

}  // namespace

Remez::Remez(Real log_kappa, int order, Shape shape) : log_kappa_(log_kappa), shape_(shape) {
  const Real complement = 1.0L / std::cosh(0.5L * log_kappa);  // of the modulus tanh(ln kappa/2)
  const Real period = complete_elliptic_k(complement);
  const auto place = [&](Real argument) {  // v of tanh(v/2) = sn(argument)
    const auto e = jacobi_elliptic(argument, complement);
    return 2.0L * std::asinh(e.sn / e.cn);
  };
  const Real end = std::numeric_limits<Real>::infinity();
  for (int j = 0; j < order; ++j) start_.push_back(place(period * (2 * j + 1) / (2 * order + 1)));
  start_.push_back(end);
  constexpr int kPerPoint = 12;
  const int steps = kPerPoint * (order + 1);
  for (int i = 0; i < steps; ++i) grid_.push_back(place(period * i / steps));
  grid_.push_back(end);
}

std::optional<Remez::Result> Remez::solve(Real beta, std::vector<Real> zeta, Real tolerance) const {
  constexpr int kMaxExchanges = 30;
  constexpr int kMaxStale = 5;
  std::vector<Real> reference = start_;
  const std::size_t reference_size = start_.size();
  Result best;
  best.error = std::numeric_limits<Real>::infinity();
  Real best_level = 0.0L;
  int stale = 0;
  for (int iteration = 0; iteration < kMaxExchanges; ++iteration) {
    Real level = 0.0L;
    for (int newton = 0; newton < (iteration == 0 ? 8 : 1); ++newton) {
      const auto reached = equalise(beta, zeta, reference);
      if (!reached) return std::nullopt;
      level = *reached;
    }
    const std::vector<Extremum> extrema = alternating_extrema(beta, zeta);
    Real largest = 0.0L;
    for (const Extremum& extremum : extrema) largest = std::max(largest, std::abs(extremum.error));
    if (largest < best.error) {
      best = {zeta, largest};
      best_level = level;
      stale = 0;
    } else if (++stale > kMaxStale) {
      break;
    }
    if (extrema.size() < reference_size) break;
    // More than needed: the outermost ones stay, the end among them.
    const std::size_t first = extrema.size() - reference_size;
    for (std::size_t j = 0; j < reference_size; ++j) reference[j] = extrema[first + j].v;
    if (largest < level * (1.0L + tolerance) + 1e-18L) return best;
  }
  // Good enough: within a percent of its own level (de la Vallee-Poussin: the true minimax lies between the
  // two), or too small for poles and zeros in doubles to show.
  if (best.error < 1.01L * best_level || best.error < 10.0L * kRounding) return best;
  return std::nullopt;
}

Real Remez::grid_error(Real beta, const std::vector<Real>& zeta) const {
  Real largest = 0.0L;
  for (const Real v : grid_) largest = std::max(largest, std::abs(error(beta, zeta, v)));
  return largest;
}

std::optional<Real> Remez::equalise(Real beta, std::vector<Real>& zeta,
                                    const std::vector<Real>& reference) const {
  LongMatrix slope;
  LongVector difference;
  for (std::size_t row = 0; row < reference.size(); ++row) {
    const Real v = reference[row];
    difference.push_back(-error(beta, zeta, v));
    slope.push_back(slopes(zeta, v));
    slope.back().push_back((reference.size() - row) % 2 == 1 ? -1.0L : 1.0L);
  }
  const LongVector step = least_squares(slope, difference);
  Real largest = 0.0L;
  for (std::size_t k = 0; k < zeta.size(); ++k) {
    if (!std::isfinite(step[k])) return std::nullopt;
    largest = std::max(largest, std::abs(step[k]));
  }
  const Real scale = largest > 1.0L ? 1.0L / largest : 1.0L;
  for (std::size_t k = 0; k < zeta.size(); ++k) zeta[k] += scale * step[k];
  return std::abs(step.back());
}

std::vector<Remez::Extremum> Remez::alternating_extrema(Real beta, const std::vector<Real>& zeta) const {
  std::vector<Real> value;
  for (const Real v : grid_) value.push_back(error(beta, zeta, v));
  std::vector<Extremum> found;
  for (std::size_t i = 1; i < grid_.size(); ++i) {
    const bool last = i + 1 == grid_.size();
    if (!last && !((value[i] - value[i - 1]) * (value[i + 1] - value[i]) <= 0.0L && value[i] != value[i - 1]))
      continue;
    // The point before the infinite end has no neighbour to bisect towards: 40 is as good as infinite.
    const Real v =
        last ? grid_[i] : turning_point(beta, zeta, grid_[i - 1], std::min(grid_[i + 1], grid_[i] + 40.0L));
    const Real e = error(beta, zeta, v);
    if (found.empty() || (e > 0.0L) != (found.back().error > 0.0L))
      found.push_back({v, e});
    else if (std::abs(e) > std::abs(found.back().error))
      found.back() = {v, e};
  }
  return found;
}

Real Remez::turning_point(Real beta, const std::vector<Real>& zeta, Real low, Real high) const {
  const bool rising = error_slope(beta, zeta, low) > 0.0L;
  const Real enough = 1e-3L * (high - low);  // the height goes with its square
  while (high - low > enough) {
    const Real middle = 0.5L * (low + high);
    ((error_slope(beta, zeta, middle) > 0.0L) == rising ? low : high) = middle;
  }
  return 0.5L * (low + high);
}

std::vector<Real> Remez::slopes(const std::vector<Real>& zeta, Real v) const {
  std::vector<Real> out;
  for (int i = 0; i < shape_.pairs; ++i) {
    const ComplexReal d = pair_slope(v, {zeta[out.size()], zeta[out.size() + 1]});
    out.push_back(d.real());
    out.push_back(-d.imag());
  }
  for (bool first = true; out.size() < zeta.size(); first = false) {
    const Real weight = first ? shape_.multiplicity : 1.0L;
    out.push_back(weight * half_lead_slope(v, std::abs(zeta[out.size()])));
  }
  return out;
}

Real Remez::error(Real beta, const std::vector<Real>& zeta, Real v) const {
  Real e = -beta * half_lead(v, log_kappa_);
  std::size_t at = 0;
  for (int i = 0; i < shape_.pairs; ++i, at += 2) e += pair_lead(v, {zeta[at], zeta[at + 1]});
  for (bool first = true; at < zeta.size(); ++at, first = false) {
    e += (first ? shape_.multiplicity : 1.0L) * half_lead(v, zeta[at]);
  }
  return e;
}

Real Remez::error_slope(Real beta, const std::vector<Real>& zeta, Real v) const {
  Real e = -beta * half_lead_slope(log_kappa_, v);
  std::size_t at = 0;
  for (int i = 0; i < shape_.pairs; ++i, at += 2) e += pair_slope_by_v(v, {zeta[at], zeta[at + 1]});
  for (bool first = true; at < zeta.size(); ++at, first = false) {
    const Real weight = (first ? shape_.multiplicity : 1.0L) * (zeta[at] < 0.0L ? -1.0L : 1.0L);
    e += weight * half_lead_slope(std::abs(zeta[at]), v);
  }
  return e;
}

}  // namespace bodesmith
