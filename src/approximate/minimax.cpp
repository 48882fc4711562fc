#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "approximate/all_methods.hpp"
#include "approximate/elliptic.hpp"
#include "approximate/limit_law.hpp"
#include "approximate/log_symmetric.hpp"
#include "base/error.hpp"
#include "base/units.hpp"

namespace bodesmith {
namespace {

using Real = long double;
using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

using ComplexReal = std::complex<Real>;

/// What the unknowns stand for: first `pairs` conjugate pairs (two numbers each, real and imaginary part of
/// zeta), then real positions, the first of them counted `multiplicity` times.
struct Shape {
  int pairs = 0;
  int multiplicity = 1;
};

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

// The unique best approximation shares the symmetry of the term (mirror it and exchange poles with zeros), so
// the error is odd in v = 2 ln w and only v >= 0 is looked at: n positions zeta_k and the level E make the
// error alternate on n + 1 points there, the last of them at the end (w infinite, or the upper corner).
class Remez {
 public:
  Remez(Real log_kappa, int order, bool over_band, Shape shape = {})
      : log_kappa_(log_kappa), order_(order), shape_(shape) {
    const Real m = std::tanh(0.5L * log_kappa);
    // Modulus k = m * (end of the interval in tanh(v/2)); 1 - k^2 without cancellation.
    const Real complement =
        over_band ? std::sqrt((1.0L - m) * (1.0L + m) * (1.0L + m * m)) : 1.0L / std::cosh(0.5L * log_kappa);
    const Real period = complete_elliptic_k_long(complement);
    const auto place = [&](Real argument) {  // v of tanh(v/2) = end * sn(argument)
      const auto e = jacobi_elliptic(argument, complement);
      if (!over_band) return 2.0L * std::asinh(e.sn / e.cn);
      return 2.0L * std::atanh(m * e.sn);
    };
    const Real end = over_band ? log_kappa : std::numeric_limits<Real>::infinity();
    for (int j = 0; j < order; ++j) start_.push_back(place(period * (2 * j + 1) / (2 * order + 1)));
    start_.push_back(end);
    constexpr int kPerPoint = 12;
    const int steps = kPerPoint * (order + 1);
    for (int i = 0; i < steps; ++i) grid_.push_back(place(period * i / steps));
    grid_.push_back(end);
  }

  struct Result {
    std::vector<Real> zeta;
    Real error = 0.0L;  ///< largest |error|, Np
  };

  /// From starting positions, until the largest error is within `tolerance` of the level; nothing when the
  /// exchange does not settle.
  std::optional<Result> solve(Real beta, std::vector<Real> zeta, Real tolerance = 1e-4L) const {
    const auto n = static_cast<size_t>(order_);
    std::vector<Real> reference = start_;
    Result best;
    best.error = std::numeric_limits<Real>::infinity();
    Real best_level = 0.0L;
    int stale = 0;
    Matrix slope(order_ + 1, order_ + 1);
    Vector miss(order_ + 1);
    for (int iteration = 0; iteration < 30; ++iteration) {
      Real level = 0.0L;
      for (int newton = 0; newton < (iteration == 0 ? 3 : 1); ++newton) {
        for (size_t j = 0; j <= n; ++j) {
          const auto row = static_cast<Eigen::Index>(j);
          miss(row) = -error(beta, zeta, reference[j]);
          fill_slopes(zeta, reference[j], slope, row);
          slope(row, order_) = (n - j) % 2 == 0 ? -1.0L : 1.0L;
        }
        const Vector step = slope.colPivHouseholderQr().solve(miss);
        const Real largest = step.head(order_).cwiseAbs().maxCoeff();
        if (!std::isfinite(largest)) return std::nullopt;
        const Real scale = largest > 1.0L ? 1.0L / largest : 1.0L;
        for (size_t k = 0; k < n; ++k) zeta[k] += scale * step(static_cast<Eigen::Index>(k));
        level = std::abs(step(order_));
      }
      const Real largest = exchange(beta, zeta, reference);
      if (largest < best.error) {
        best = {zeta, largest};
        best_level = level;
        stale = 0;
      } else if (++stale > 5) {
        break;
      }
      if (reference.size() != n + 1) break;
      if (largest < level * (1.0L + tolerance) + 1e-18L) return best;
    }
    // Good enough: within a percent of its own level (de la Vallee-Poussin: the true minimax lies between the
    // two), or too small for poles and zeros in doubles to show.
    if (best.error < 1.01L * best_level || best.error < 10.0L * kRounding) return best;
    return std::nullopt;
  }

  /// Largest |error| of given positions, on the grid.
  Real grid_error(Real beta, const std::vector<Real>& zeta) const {
    Real largest = 0.0L;
    for (const Real v : grid_) largest = std::max(largest, std::abs(error(beta, zeta, v)));
    return largest;
  }

  static constexpr Real kRounding = 1e-15L;  ///< Np: about what rounding the roots to doubles does

 private:
  void fill_slopes(const std::vector<Real>& zeta, Real v, Matrix& slope, Eigen::Index row) const {
    Eigen::Index at = 0;
    for (; at < 2 * shape_.pairs; at += 2) {
      const auto k = static_cast<size_t>(at);
      const ComplexReal d = pair_slope(v, {zeta[k], zeta[k + 1]});
      slope(row, at) = d.real();
      slope(row, at + 1) = -d.imag();
    }
    for (bool first = true; at < order_; ++at, first = false) {
      const Real weight = first ? shape_.multiplicity : 1.0L;
      slope(row, at) = weight * half_lead_slope(v, std::abs(zeta[static_cast<size_t>(at)]));
    }
  }
  Real error(Real beta, const std::vector<Real>& zeta, Real v) const {
    Real e = -beta * half_lead(v, log_kappa_);
    size_t at = 0;
    for (int i = 0; i < shape_.pairs; ++i, at += 2) e += pair_lead(v, {zeta[at], zeta[at + 1]});
    for (bool first = true; at < zeta.size(); ++at, first = false) {
      e += (first ? shape_.multiplicity : 1.0L) * half_lead(v, zeta[at]);
    }
    return e;
  }
  Real error_slope(Real beta, const std::vector<Real>& zeta, Real v) const {
    Real e = -beta * half_lead_slope(log_kappa_, v);
    size_t at = 0;
    for (int i = 0; i < shape_.pairs; ++i, at += 2) e += pair_slope_by_v(v, {zeta[at], zeta[at + 1]});
    for (bool first = true; at < zeta.size(); ++at, first = false) {
      const Real weight = (first ? shape_.multiplicity : 1.0L) * (zeta[at] < 0.0L ? -1.0L : 1.0L);
      e += weight * half_lead_slope(std::abs(zeta[at]), v);
    }
    return e;
  }

  /// Moves the reference to the alternating extrema of the error; returns the largest |error|.
  Real exchange(Real beta, const std::vector<Real>& zeta, std::vector<Real>& reference) const {
    std::vector<Real> value;
    for (const Real v : grid_) value.push_back(error(beta, zeta, v));
    std::vector<Real> at;
    std::vector<Real> height;
    for (size_t i = 1; i < grid_.size(); ++i) {
      const bool last = i + 1 == grid_.size();
      if (!last &&
          !((value[i] - value[i - 1]) * (value[i + 1] - value[i]) <= 0.0L && value[i] != value[i - 1]))
        continue;
      Real v = grid_[i];
      if (!last) {
        Real low = grid_[i - 1];
        Real high = std::min(grid_[i + 1], grid_[i] + 40.0L);
        const bool rising = error_slope(beta, zeta, low) > 0.0L;
        const Real enough = 1e-3L * (high - low);  // the height goes with its square
        while (high - low > enough) {
          const Real middle = 0.5L * (low + high);
          ((error_slope(beta, zeta, middle) > 0.0L) == rising ? low : high) = middle;
        }
        v = 0.5L * (low + high);
      }
      const Real e = error(beta, zeta, v);
      if (!at.empty() && (e > 0.0L) == (height.back() > 0.0L)) {
        if (std::abs(e) > std::abs(height.back())) {
          at.back() = v;
          height.back() = e;
        }
      } else {
        at.push_back(v);
        height.push_back(e);
      }
    }
    Real largest = 0.0L;
    for (const Real e : height) largest = std::max(largest, std::abs(e));
    const auto wanted = static_cast<size_t>(order_) + 1;
    if (at.size() > wanted) at.erase(at.begin(), at.end() - static_cast<std::ptrdiff_t>(wanted));
    reference = at;
    return largest;
  }

  Real log_kappa_;
  int order_;  ///< unknowns
  Shape shape_;
  std::vector<Real> start_;
  std::vector<Real> grid_;
};

/// Where the limit law is below rounding the exchange has nothing to work on, and the mid-band Pade
/// positions are as good; with one whole power split off where beta > 1.
std::optional<Remez::Result> closed_form(const Remez& remez, double kappa, Real log_kappa, int order,
                                         Real beta) {
  if (minimax_limit_db(kappa, static_cast<double>(beta), order) > kDecibelPerNeper * Remez::kRounding)
    return std::nullopt;
  Remez::Result out;
  if (beta < 1.0L) {
    out.zeta = pade_positions(log_kappa, beta, order);
  } else {
    out.zeta = pade_positions(log_kappa, beta - 1.0L, order - 1);
    out.zeta.push_back(log_kappa);
  }
  out.error = remez.grid_error(beta, out.zeta);
  if (out.error > 10.0L * Remez::kRounding) return std::nullopt;
  return out;
}

/// Solves at `beta`, 0 < beta < 2, if need be along a path in beta, on which the positions move smoothly. At
/// beta = 1 the error is 0 and the positions are not unique; the path steps over it.
std::optional<Remez::Result> follow(const Remez& remez, Real log_kappa, int order, Real beta, Real step) {
  // Up to a decade the Pade positions are within tens of percent of the best error already.
  if (log_kappa < 2.4L) {
    if (auto direct = remez.solve(beta, pade_positions(log_kappa, beta, order))) return direct;
  }
  constexpr Real kElliptic = 1.4L;  // the elliptic positions fold back at 3/2
  if (beta <= kElliptic) {
    if (auto direct = remez.solve(beta, elliptic_positions(log_kappa, beta, order))) return direct;
  }
  // Towards beta = 2 the two lowest zeros approach each other like a square root: sum and squared difference
  // of their positions stay smooth.
  const auto smooth = [&](std::vector<Real> zeta) {
    if (order >= 2) {
      const Real half = 0.5L * (zeta[0] - zeta[1]);
      zeta[0] = 0.5L * (zeta[0] + zeta[1]);
      zeta[1] = half * half;
    }
    return zeta;
  };
  const auto unsmooth = [&](std::vector<Real> zeta) {
    if (order >= 2) {
      const Real half = std::sqrt(std::max(zeta[1], 1e-6L));
      zeta[1] = zeta[0] - half;
      zeta[0] += half;
    }
    return zeta;
  };
  std::vector<Real> done;
  std::vector<std::vector<Real>> path;
  std::optional<Remez::Result> result;
  const auto go = [&](Real to, std::vector<Real> from) {
    result = remez.solve(to, std::move(from), to == beta ? 1e-4L : 0.1L);
    if (result) {
      done.push_back(to);
      path.push_back(smooth(result->zeta));
    }
  };
  const std::array<Real, 2> first = beta < 1.0L   ? std::array{0.4L, 0.55L}
                                    : beta < 1.2L ? std::array{1.4L, 1.25L}
                                                  : std::array{1.15L, 1.3L};
  for (const Real at : first) go(at, elliptic_positions(log_kappa, at, order));
  while (result && done.back() != beta) {
    const Real at =
        std::abs(beta - done.back()) <= step ? beta : done.back() + (beta > done.back() ? step : -step);
    std::vector<Real> guess(static_cast<size_t>(order), 0.0L);
    const size_t use = std::min<size_t>(4, done.size());
    for (size_t i = done.size() - use; i < done.size(); ++i) {
      Real weight = 1.0L;
      for (size_t j = done.size() - use; j < done.size(); ++j) {
        if (j != i) weight *= (at - done[j]) / (done[i] - done[j]);
      }
      for (size_t k = 0; k < guess.size(); ++k) guess[k] += weight * path[i][k];
    }
    go(at, unsmooth(std::move(guess)));
  }
  return result;
}

/// beta > 2, complex pairs allowed: from the Pade positions of a narrow term along a path in ln kappa.
std::optional<NormalisedApproximation> whole_with_pairs(Real log_kappa, Real beta, int order, bool over_band,
                                                        Real growth) {
  constexpr Real kNarrow = 1.6L;
  Real at = std::min(log_kappa, kNarrow);
  std::vector<ComplexReal> start = pade_positions_complex(at, beta, order);
  Shape shape;
  std::vector<Real> zeta;
  std::vector<Real> reals;
  for (const ComplexReal& z : start) {
    if (z.imag() > 0.0L) {
      ++shape.pairs;
      zeta.push_back(z.real());
      zeta.push_back(z.imag());
    } else if (z.imag() == 0.0L) {
      reals.push_back(z.real());
    }
  }
  std::sort(reals.begin(), reals.end(), std::greater<>());
  zeta.insert(zeta.end(), reals.begin(), reals.end());
  std::vector<Real> done;
  std::vector<std::vector<Real>> path;
  for (;;) {
    const bool last = at == log_kappa;
    const auto result = Remez(at, order, over_band, shape).solve(beta, zeta, last ? 1e-4L : 0.03L);
    if (!result) return std::nullopt;
    done.push_back(at);
    path.push_back(result->zeta);
    if (last) break;
    at = std::min(log_kappa, at * growth);
    const size_t use = std::min<size_t>(3, done.size());
    std::fill(zeta.begin(), zeta.end(), 0.0L);
    for (size_t i = done.size() - use; i < done.size(); ++i) {
      Real weight = 1.0L;
      for (size_t j = done.size() - use; j < done.size(); ++j) {
        if (j != i) weight *= (at - done[j]) / (done[i] - done[j]);
      }
      // With one solution only: in proportion.
      if (use == 1) weight = at / done[0];
      for (size_t k = 0; k < zeta.size(); ++k) zeta[k] += weight * path[i][k];
    }
  }
  const std::vector<Real>& found = path.back();
  std::vector<ComplexReal> positions;
  size_t k = 0;
  for (int i = 0; i < shape.pairs; ++i, k += 2) {
    positions.emplace_back(found[k], found[k + 1]);
    positions.emplace_back(found[k], -found[k + 1]);
  }
  for (; k < found.size(); ++k) positions.emplace_back(found[k], 0.0L);
  return from_log_positions_complex(positions, log_kappa, beta);
}

}  // namespace

NormalisedApproximation minimax(const ApproximationTask& task) {
  const Real log_kappa = std::log(static_cast<Real>(task.kappa));
  const Real beta = task.beta;
  // Above beta = 2 the best positions leave the real axis. The best real ones then are a multiple root beyond
  // the corner and simple ones for the rest; it starts from as many whole powers split off, each a pole and a
  // zero at the corners.
  const int whole =
      beta == std::round(beta) ? static_cast<int>(beta) : std::max(0, static_cast<int>(beta) - 1);
  const int order = task.order - whole;
  const Real rest = beta - whole;
  if (order < 0 || (rest > 0.0L && order < 1) || (rest > 1.0L && order < 2)) {
    throw DesignError("minimax needs an order of at least |beta| rounded up");
  }
  if (!task.real_roots && beta > 2.0L && rest > 0.0L) {
    if (minimax_limit_db(task.kappa, task.beta, task.order) < kDecibelPerNeper * Remez::kRounding) {
      return from_log_positions_complex(pade_positions_complex(log_kappa, beta, task.order), log_kappa, beta);
    }
    for (const Real growth : {1.2L, 1.05L}) {
      if (auto found = whole_with_pairs(log_kappa, beta, task.order, task.over_band, growth)) return *found;
    }
    throw DesignError(
        "minimax with complex pairs did not converge for this term, expected real roots or another order");
  }
  std::vector<Real> zeta(static_cast<size_t>(whole), log_kappa);
  if (rest > 0.0L) {
    const Remez remez(log_kappa, order, task.over_band);
    auto result = closed_form(remez, task.kappa, log_kappa, order, rest);
    const bool exact = result.has_value();
    for (const Real step : {0.2L, 0.1L, 0.04L, 0.015L}) {
      if (!result) result = follow(remez, log_kappa, order, rest, step);
    }
    if (!result)
      throw DesignError("minimax did not converge for this term, expected another order or method");
    if (whole > 0 && !exact) {
      const int multiplicity = whole + 1;
      std::vector<Real> start = result->zeta;
      start[0] = (whole * log_kappa + start[0]) / multiplicity;
      const auto better = Remez(log_kappa, order, task.over_band, {0, multiplicity}).solve(beta, start);
      if (better && better->error < result->error) {
        result = better;
        std::fill(zeta.begin(), zeta.end(), better->zeta[0]);
      }
    }
    zeta.insert(zeta.end(), result->zeta.begin(), result->zeta.end());
  }
  return from_log_positions(zeta, log_kappa, beta);
}

}  // namespace bodesmith
