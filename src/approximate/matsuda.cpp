#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <vector>

#include "approximate/all_methods.hpp"
#include "approximate/log_symmetric.hpp"
#include "base/error.hpp"

namespace bodesmith {
namespace {

namespace mp = boost::multiprecision;
using Real = mp::number<mp::cpp_bin_float<140>, mp::et_off>;

/// Thiele's continued fraction a0 + (s - s0)/(a1 + (s - s1)/(a2 + ...)).
struct Thiele {
  std::vector<Real> node;
  std::vector<Real> a;

  Thiele(std::vector<Real> nodes, std::vector<Real> value) : node(std::move(nodes)) {
    for (size_t k = 0; k < node.size(); ++k) {
      a.push_back(value[k]);
      for (size_t i = k + 1; i < node.size(); ++i) value[i] = (node[i] - node[k]) / (value[i] - a[k]);
    }
  }

  /// Numerator and its derivative, by the recurrence of the convergents.
  std::pair<Real, Real> numerator(const Real& s) const {
    Real before = 1;
    Real before_slope = 0;
    Real now = a[0];
    Real slope = 0;
    for (size_t k = 1; k < a.size(); ++k) {
      const Real x = s - node[k - 1];
      const Real next = a[k] * now + x * before;
      const Real next_slope = a[k] * slope + x * before_slope + before;
      before = now;
      before_slope = slope;
      now = next;
      slope = next_slope;
    }
    return {now, slope};
  }
};

}  // namespace

// The fraction through 2n + 1 values loses all digits of a double from order 7 on, because neighbouring
// convergents agree to more than 16 digits: it is carried with 140. Nodes and function mirror each other
// about the centre, so the poles are the reciprocals of the zeros.
NormalisedApproximation matsuda(const ApproximationTask& task) {
  const int n = task.order;
  const Real r = sqrt(Real(task.kappa));
  std::vector<Real> node;
  std::vector<Real> value;  // (P/r)^beta
  for (int j = 0; j <= 2 * n; ++j) {
    // Nodes from the corners inwards and the centre last: neighbours in the fraction then differ most.
    const int place = j % 2 == 0 ? j / 2 : 2 * n - j / 2;
    const Real s = pow(r, Real(place - n) / n);
    node.push_back(s);
    value.push_back(pow((1 + r * s) / (r + s), Real(task.beta)));
  }
  const Thiele thiele(std::move(node), std::move(value));

  const long double log_kappa = std::log(static_cast<long double>(task.kappa));
  const auto start = log_kappa < 4.0L ? pade_positions(log_kappa, task.beta, n)
                                      : elliptic_positions(log_kappa, task.beta, n);
  std::vector<Real> zero;
  for (const long double z : start) zero.push_back(-exp(Real(-0.5L * z)));
  bool settled = false;
  // Aberth's iteration for all zeros at once.
  for (int iteration = 0; iteration < 60 && !settled; ++iteration) {
    Real largest = 0;
    for (size_t k = 0; k < zero.size(); ++k) {
      const auto [p, slope] = thiele.numerator(zero[k]);
      Real repulsion = 0;
      for (size_t i = 0; i < zero.size(); ++i) {
        if (i != k) repulsion += 1 / (zero[k] - zero[i]);
      }
      const Real step = p / (slope - p * repulsion);
      zero[k] -= step;
      largest = std::max(largest, Real(abs(step / zero[k])));
    }
    settled = largest < Real(1e-19);
  }
  std::vector<long double> zeta;
  for (const Real& z : zero) {
    settled = settled && z < 0;
    if (settled) zeta.push_back(static_cast<long double>(-2 * log(-z)));
  }
  if (!settled)
    throw DesignError("matsuda did not converge for this term, expected a lower order or another method");
  return from_log_positions(zeta, log_kappa, task.beta);
}

}  // namespace bodesmith
