#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "approximate/approximation_error.hpp"
#include "approximate/log_symmetric.hpp"
#include "approximate/method.hpp"
#include "approximate/remez.hpp"
#include "base/units.hpp"
#include "base/whole_number.hpp"
#include "numeric/optimisation/minimum.hpp"

namespace bodesmith {
namespace {

using Positions = std::vector<long double>;
using ComplexPositions = std::vector<std::complex<long double>>;

/// Whether the best error (minimax_limit_db) is smaller than what rounding the roots to doubles does.
bool below_rounding(double kappa, double beta, int order) {
  return !(minimax_limit_db(kappa, beta, order) > kDecibelPerNeper * Remez::kRounding);
}

/// Solutions along a path in one parameter (beta, or ln kappa), on which positions move smoothly: the next start is
/// what the polynomial through the last few predicts.
class SolutionPath {
 public:
  /// Predicts from at most so many solutions.
  explicit SolutionPath(std::size_t max_points) : max_points_(max_points) {}

  void add(long double at, Positions positions) {
    at_.push_back(at);
    positions_.push_back(std::move(positions));
  }
  std::size_t size() const { return at_.size(); }
  long double first_at() const { return at_.front(); }
  long double last_at() const { return at_.back(); }

  /// Lagrange's interpolation through the last solutions.
  Positions predict(long double at) const {
    Positions out(positions_.back().size(), 0.0L);
    const std::size_t first = at_.size() - std::min(max_points_, at_.size());
    for (std::size_t i = first; i < at_.size(); ++i) {
      long double weight = 1.0L;
      for (std::size_t j = first; j < at_.size(); ++j) {
        if (j != i) weight *= (at - at_[j]) / (at_[i] - at_[j]);
      }
      for (std::size_t k = 0; k < out.size(); ++k) out[k] += weight * positions_[i][k];
    }
    return out;
  }

 private:
  std::size_t max_points_;
  std::vector<long double> at_;
  std::vector<Positions> positions_;
};

/// Where the limit law is below rounding the exchange has nothing to work on, and the mid-band Pade positions are as
/// good; with one whole power split off where beta > 1.
std::optional<Remez::Result> closed_form(const Remez& remez, double kappa, long double log_kappa, int order,
                                         long double beta) {
  if (!below_rounding(kappa, static_cast<double>(beta), order)) return std::nullopt;
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

/// Straight from positions known to be near.
std::optional<Remez::Result> solve_directly(const Remez& remez, long double log_kappa, int order,
                                            long double beta) {
  // Up to a decade the Pade positions are within tens of percent of the best error already.
  if (log_kappa < 2.4L) {
    if (auto direct = remez.solve(beta, pade_positions(log_kappa, beta, order))) return direct;
  }
  constexpr long double kElliptic = 1.4L;  // the elliptic positions fold back at 3/2
  if (beta > kElliptic) return std::nullopt;
  return remez.solve(beta, elliptic_positions(log_kappa, beta, order));
}

/// Towards beta = 2 the two lowest zeros approach each other like a square root: sum and squared difference of their
/// positions stay smooth.
Positions to_smooth(Positions zeta) {
  if (zeta.size() >= 2) {
    const long double half = 0.5L * (zeta[0] - zeta[1]);
    zeta[0] = 0.5L * (zeta[0] + zeta[1]);
    zeta[1] = half * half;
  }
  return zeta;
}
Positions from_smooth(Positions zeta) {
  if (zeta.size() >= 2) {
    const long double half = std::sqrt(std::max(zeta[1], 1e-6L));
    zeta[1] = zeta[0] - half;
    zeta[0] += half;
  }
  return zeta;
}

/// Solves at `beta`, 0 < beta < 2, along a path in beta. At beta = 1 the error is 0 and the positions are not unique;
/// the path steps over it.
std::optional<Remez::Result> follow_beta(const Remez& remez, long double log_kappa, int order,
                                         long double beta, long double step) {
  constexpr long double kOnTheWay = 0.1L;  // tolerance: the next start needs no more
  SolutionPath path(4);
  std::optional<Remez::Result> result;
  const auto solve_at = [&](long double at, Positions from) {
    result = remez.solve(at, std::move(from), at == beta ? Remez::kTolerance : kOnTheWay);
    if (result) path.add(at, to_smooth(result->zeta));
  };
  // Where the elliptic positions are near the solution.
  const std::array<long double, 2> first = beta < 1.0L   ? std::array{0.4L, 0.55L}
                                           : beta < 1.2L ? std::array{1.4L, 1.25L}
                                                         : std::array{1.15L, 1.3L};
  for (const long double at : first) solve_at(at, elliptic_positions(log_kappa, at, order));
  while (result && path.last_at() != beta) {
    const long double here = path.last_at();
    const long double at = std::abs(beta - here) <= step ? beta : here + (beta > here ? step : -step);
    solve_at(at, from_smooth(path.predict(at)));
  }
  return result;
}

/// 0 < beta < 2: in closed form, directly, or along paths of smaller and smaller steps.
std::optional<Remez::Result> solve_real(const Remez& remez, long double log_kappa, int order,
                                        long double beta) {
  std::optional<Remez::Result> result = solve_directly(remez, log_kappa, order, beta);
  for (const long double step : {0.2L, 0.1L, 0.04L, 0.015L}) {
    if (!result) result = follow_beta(remez, log_kappa, order, beta, step);
  }
  return result;
}

/// Unknowns of an exchange with conjugate pairs, from positions closed under conjugation, and back.
struct PairedPositions {
  int pairs = 0;
  Positions zeta;
};
PairedPositions to_pairs(const ComplexPositions& positions) {
  PairedPositions out;
  Positions reals;
  for (const auto& z : positions) {
    if (z.imag() > 0.0L) {
      ++out.pairs;
      out.zeta.push_back(z.real());
      out.zeta.push_back(z.imag());
    } else if (z.imag() == 0.0L) {
      reals.push_back(z.real());
    }
  }
  std::ranges::sort(reals, std::greater<>());
  out.zeta.insert(out.zeta.end(), reals.begin(), reals.end());
  return out;
}
ComplexPositions from_pairs(const PairedPositions& paired) {
  ComplexPositions out;
  std::size_t k = 0;
  for (int i = 0; i < paired.pairs; ++i, k += 2) {
    out.emplace_back(paired.zeta[k], paired.zeta[k + 1]);
    out.emplace_back(paired.zeta[k], -paired.zeta[k + 1]);
  }
  for (; k < paired.zeta.size(); ++k) out.emplace_back(paired.zeta[k], 0.0L);
  return out;
}

/// beta > 2, complex pairs allowed: from the Pade positions of a narrow term along a path in ln kappa, which grows by
/// the factor `growth` a step.
std::optional<ComplexPositions> follow_kappa(const ApproximationTask& task, long double growth) {
  constexpr long double kNarrow = 1.6L;
  constexpr long double kOnTheWay = 0.03L;
  const long double log_kappa = std::log(static_cast<long double>(task.kappa));
  const long double beta = task.beta;
  long double at = std::min(log_kappa, kNarrow);
  PairedPositions paired = to_pairs(pade_positions_complex(at, beta, task.order));
  SolutionPath path(3);
  for (;;) {
    const bool last = at == log_kappa;
    const Remez remez(at, task.order, {paired.pairs, 1});
    const auto result = remez.solve(beta, paired.zeta, last ? Remez::kTolerance : kOnTheWay);
    if (!result) return std::nullopt;
    paired.zeta = result->zeta;
    if (last) return from_pairs(paired);
    path.add(at, result->zeta);
    at = std::min(log_kappa, at * growth);
    if (path.size() == 1) {
      // One solution only: in proportion.
      for (long double& z : paired.zeta) z *= at / path.first_at();
    } else {
      paired.zeta = path.predict(at);
    }
  }
}

Outcome<ComplexPositions> minimax_with_pairs(const ApproximationTask& task) {
  if (below_rounding(task.kappa, task.beta, task.order))
    return pade_positions_complex(std::log(static_cast<long double>(task.kappa)), task.beta, task.order);
  for (const long double growth : {1.2L, 1.05L}) {
    if (auto found = follow_kappa(task, growth)) return *found;
  }
  return Refusal{
      "minimax with complex pairs did not converge for this term, expected real roots or another order"};
}

/// Fewer poles than |beta|: the best real ones are all at one place, found by search. `asked`: ln kappa of the term that was asked for.
ComplexPositions minimax_of_one_place(const ApproximationTask& task, long double asked) {
  const long double log_kappa = std::log(static_cast<long double>(task.kappa));
  const long double beta = task.beta;
  const Remez remez(log_kappa, task.order, {});
  const auto places = [&](long double at) { return Positions(static_cast<std::size_t>(task.order), at); };
  const auto error = [&](long double at) { return remez.grid_error(beta, places(at)); };
  // Where the total change is right, and up to twice that.
  long double highest = 2.0L * log_kappa * beta / task.order;
  if (task.over_band) {  // of the term that was asked for; e^30 corners further out is as good as nowhere
    const long double far = std::min(2.0L * asked * beta / task.order, asked + 30.0L);
    highest = std::log(std::cosh(0.5L * (asked + far)) / std::cosh(0.5L * (asked - far)));
  }
  const long double best = minimum_between(0.5L * log_kappa, highest, 1e-12L * log_kappa, error);
  return ComplexPositions(static_cast<std::size_t>(task.order), best);
}

/// Above beta = 2 the best positions leave the real axis. The best real ones then are a multiple root beyond the corner
/// and simple ones for the rest; the search starts from as many whole powers split off, each a pole and a zero at the
/// corners.
Outcome<ComplexPositions> best_positions(const ApproximationTask& task, long double asked) {
  const long double log_kappa = std::log(static_cast<long double>(task.kappa));
  const long double beta = task.beta;
  const int whole =
      beta == std::round(beta) ? whole_number<int>(task.beta) : whole_number<int>(task.beta - 1.0, 0);
  const int order = task.order - whole;
  const long double rest = beta - whole;
  if (order < 0 || (rest > 0.0L && order < 1) || (rest > 1.0L && order < 2))
    return minimax_of_one_place(task, asked);
  if (!task.real_roots && beta > 2.0L && rest > 0.0L) return minimax_with_pairs(task);
  Positions zeta(static_cast<std::size_t>(whole), log_kappa);
  if (rest > 0.0L) {
    const Remez remez(log_kappa, order, {});
    auto result = closed_form(remez, task.kappa, log_kappa, order, rest);
    const bool exact = result.has_value();
    if (!exact) result = solve_real(remez, log_kappa, order, rest);
    if (!result) return Refusal{"minimax did not converge for this term, expected another order or method"};
    if (whole > 0 && !exact) {
      const int multiplicity = whole + 1;
      Positions start = result->zeta;
      start[0] = (whole * log_kappa + start[0]) / multiplicity;
      const auto multiple = Remez(log_kappa, order, {0, multiplicity}).solve(beta, start);
      if (multiple && multiple->error < result->error) {
        result = multiple;
        std::ranges::fill(zeta, multiple->zeta[0]);
      }
    }
    zeta.insert(zeta.end(), result->zeta.begin(), result->zeta.end());
  }
  return ComplexPositions(zeta.begin(), zeta.end());
}

/// Equal ripple between the corners is equal ripple over all frequencies of a narrower term: with tanh(v/2) = tau tanh(L/2),
/// L = ln kappa, half_lead(v, z) is artanh(tau tanh(L/2) tanh(z/2)), and tau goes up to 1. That term has
///   L' = 2 artanh(tanh(L/2)^2) = ln cosh L,
/// and where its positions are z' those sought have tanh(z/2) = tanh(z'/2)/tanh(L/2):
///   z = ln(sinh((L + z')/2)/sinh((L - z')/2)).
ApproximationTask of_the_band(ApproximationTask task) {
  task.kappa = std::cosh(std::log(task.kappa));
  return task;
}
/// Nothing where a position lies beyond all frequencies.
std::optional<ComplexPositions> from_the_band(ComplexPositions zeta, long double log_kappa) {
  for (std::complex<long double>& z : zeta) {
    if (z.imag() != 0.0L) {
      z = std::log(std::sinh(0.5L * (log_kappa + z)) / std::sinh(0.5L * (log_kappa - z)));
    } else if (std::abs(z.real()) < log_kappa) {
      z = std::log(std::sinh(0.5L * (log_kappa + z.real())) / std::sinh(0.5L * (log_kappa - z.real())));
    } else {
      return std::nullopt;
    }
  }
  return zeta;
}

/// Equal ripple in log magnitude over all frequencies (or between the corners): the best there is. By Remez exchange on log pole
/// and zero positions.
class Minimax final : public Method {
 public:
  std::string_view name() const override { return "minimax"; }
  bool splits_whole_powers() const override { return false; }
  Outcome<NormalisedApproximation> approximate(const ApproximationTask& task) const override {
    const long double log_kappa = std::log(static_cast<long double>(task.kappa));
    auto found = best_positions(task.over_band ? of_the_band(task) : task, log_kappa);
    if (auto* refusal = std::get_if<Refusal>(&found)) return std::move(*refusal);
    auto zeta = std::get<ComplexPositions>(std::move(found));
    if (task.over_band) {
      auto inside = from_the_band(std::move(zeta), log_kappa);
      if (!inside)
        return Refusal{
            "minimax between the corners needs a root beyond all frequencies, expected more poles"};
      zeta = std::move(*inside);
    }
    return from_log_positions(zeta, log_kappa, task.beta);
  }
};

}  // namespace

BODESMITH_ENTRY(Method, minimax_method, Minimax)

}  // namespace bodesmith
