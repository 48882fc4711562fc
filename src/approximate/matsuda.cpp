#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <optional>
#include <vector>

#include "approximate/log_symmetric.hpp"
#include "approximate/method.hpp"

namespace bodesmith {
namespace {

/// 140 decimal digits: the fraction through 2n + 1 values loses all digits of a double from order 7 on, because
/// neighbouring convergents agree to more than 16 digits.
using ManyDigits =
    boost::multiprecision::number<boost::multiprecision::cpp_bin_float<140>, boost::multiprecision::et_off>;

/// Thiele's continued fraction a0 + (s - s0)/(a1 + (s - s1)/(a2 + ...)).
struct Thiele {
  std::vector<ManyDigits> node;
  std::vector<ManyDigits> a;

  Thiele(std::vector<ManyDigits> nodes, std::vector<ManyDigits> value) : node(std::move(nodes)) {
    for (std::size_t k = 0; k < node.size(); ++k) {
      a.push_back(value[k]);
      for (std::size_t i = k + 1; i < node.size(); ++i) value[i] = (node[i] - node[k]) / (value[i] - a[k]);
    }
  }

  /// Numerator and its derivative, by the recurrence of the convergents.
  std::pair<ManyDigits, ManyDigits> numerator(const ManyDigits& s) const {
    ManyDigits before = 1;
    ManyDigits before_slope = 0;
    ManyDigits now = a[0];
    ManyDigits slope = 0;
    for (std::size_t k = 1; k < a.size(); ++k) {
      const ManyDigits x = s - node[k - 1];
      const ManyDigits next = a[k] * now + x * before;
      const ManyDigits next_slope = a[k] * slope + x * before_slope + before;
      before = now;
      before_slope = slope;
      now = next;
      slope = next_slope;
    }
    return {now, slope};
  }
};

/// The fraction through (P/r)^beta at s = kappa^(-1/2) .. kappa^(1/2), evenly spaced in log s.
Thiele fraction_through_the_term(const ApproximationTask& task) {
  const int n = task.order;
  const ManyDigits r = sqrt(ManyDigits(task.kappa));
  std::vector<ManyDigits> node;
  std::vector<ManyDigits> value;
  for (int j = 0; j <= 2 * n; ++j) {
    // Nodes from the corners inwards and the centre last: neighbours in the fraction then differ most.
    const int place = j % 2 == 0 ? j / 2 : 2 * n - j / 2;
    const ManyDigits s = pow(r, ManyDigits(place - n) / n);
    node.push_back(s);
    value.push_back(pow((1 + r * s) / (r + s), ManyDigits(task.beta)));
  }
  return {std::move(node), std::move(value)};
}

/// Its zeros from `zero` on, all at once (Aberth's iteration); nothing when that does not settle on negative ones.
std::optional<std::vector<ManyDigits>> aberth_zeros(const Thiele& thiele, std::vector<ManyDigits> zero) {
  constexpr int kMaxIterations = 60;
  const ManyDigits tolerance(1e-19);
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    ManyDigits largest = 0;
    for (std::size_t k = 0; k < zero.size(); ++k) {
      const auto [p, slope] = thiele.numerator(zero[k]);
      ManyDigits repulsion = 0;
      for (std::size_t i = 0; i < zero.size(); ++i) {
        if (i != k) repulsion += 1 / (zero[k] - zero[i]);
      }
      const ManyDigits step = p / (slope - p * repulsion);
      zero[k] -= step;
      largest = std::max(largest, ManyDigits(abs(step / zero[k])));
    }
    if (largest < tolerance) {
      const bool negative = std::ranges::all_of(zero, [](const ManyDigits& z) { return z < 0; });
      if (negative) return zero;
      return std::nullopt;
    }
  }
  return std::nullopt;
}

/// Rational interpolation at real s, evenly spaced in log s (Matsuda and Fujii, J. Guid. Control Dyn. 16, 1993). Nodes
/// and function mirror each other about the centre, so the poles are the reciprocals of the zeros.
class Matsuda final : public Method {
 public:
  std::string_view name() const override { return "matsuda"; }
  Outcome<NormalisedApproximation> approximate(const ApproximationTask& task) const override;
};

Outcome<NormalisedApproximation> Matsuda::approximate(const ApproximationTask& task) const {
  const long double log_kappa = std::log(static_cast<long double>(task.kappa));
  // The Pade positions are near where the term is narrow, the elliptic ones where it is wide.
  const auto start = log_kappa < 4.0L ? pade_positions(log_kappa, task.beta, task.order)
                                      : elliptic_positions(log_kappa, task.beta, task.order);
  std::vector<ManyDigits> zero;
  for (const long double z : start) zero.push_back(-exp(ManyDigits(-0.5L * z)));
  const auto found = aberth_zeros(fraction_through_the_term(task), std::move(zero));
  if (!found)
    return Refusal{"matsuda did not converge for this term, expected a lower order or another method"};
  std::vector<std::complex<long double>> zeta;
  for (const ManyDigits& z : *found) zeta.push_back(static_cast<long double>(-2 * log(-z)));
  return from_log_positions(zeta, log_kappa, task.beta);
}

}  // namespace

BODESMITH_ENTRY(Method, matsuda_method, Matsuda)

}  // namespace bodesmith
