#include "fit/direct/rational_start.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <complex>

#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"

namespace bodesmith {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kLawsonRounds = 40;

/// N/D = sum alpha_j/(x - z_j) / sum beta_j/(x - z_j), of type (n, n) for n + 1 support points.
struct Barycentric {
  std::vector<Index> support;
  VectorXd alpha, beta;
};

/// |H|^2 over x = (w/reference)^2.
class MagnitudeSquare {
 public:
  MagnitudeSquare(const CurveTarget& target, double reference)
      : x_(eigen_index(target.frequency.size())), f_(x_.size()), weight_(as_eigen(target.weight)) {
    for (Index i = 0; i < x_.size(); ++i) {
      const double w = target.frequency[std_index(i)].value / reference;
      x_(i) = w * w;
      f_(i) = std::exp(2.0 * target.log_gain[std_index(i)]);
    }
  }

  double support_x(Index i) const { return x_(i); }
  Barycentric fit(int order) const;

 private:
  /// Weighted relative errors of ln, and |D| for the next weights.
  struct Errors {
    VectorXd error;
    VectorXd size;
  };
  Errors errors(const Barycentric& r) const;
  /// Least squares of weights times (N - f D) with |alpha|, |beta| of unit size.
  void solve(Barycentric& r, const VectorXd& row_weight) const;

  VectorXd x_, f_;
  VectorXd weight_;
};

MagnitudeSquare::Errors MagnitudeSquare::errors(const Barycentric& r) const {
  Errors out{VectorXd(x_.size()), VectorXd(x_.size())};
  for (Index i = 0; i < x_.size(); ++i) {
    double top = 0.0, bottom = 0.0;
    bool at_support = false;
    for (std::size_t j = 0; j < r.support.size() && !at_support; ++j) {
      const double distance = x_(i) - x_(r.support[j]);
      const Index k = eigen_index(j);
      if (distance == 0.0) {
        at_support = true;
        top = r.alpha(k);
        bottom = r.beta(k);
      } else {
        top += r.alpha(k) / distance;
        bottom += r.beta(k) / distance;
      }
    }
    // A quotient below zero counts as far off.
    const double ratio = top / bottom / f_(i);
    out.error(i) =
        weight_(i) * (ratio > 0.0 ? 0.5 * std::log(ratio) : (std::isfinite(ratio) ? ratio - 1.0 : 1e3));
    out.size(i) = std::abs(bottom);
  }
  return out;
}

void MagnitudeSquare::solve(Barycentric& r, const VectorXd& row_weight) const {
  const Index n = eigen_index(r.support.size());
  MatrixXd rows(x_.size(), 2 * n);
  for (Index i = 0; i < x_.size(); ++i) {
    const double scale = row_weight(i) / f_(i);
    const auto own = std::ranges::find(r.support, i);
    for (Index j = 0; j < n; ++j) {
      double part = scale;
      if (own != r.support.end()) {
        part *= own - r.support.begin() == j ? 1.0 : 0.0;
      } else {
        part /= x_(i) - x_(r.support[std_index(j)]);
      }
      rows(i, j) = part * f_(r.support[std_index(j)]);  // alpha in units of f there
      rows(i, n + j) = -part * f_(i);
    }
  }
  // Columns of one size: the points span decades.
  VectorXd column = rows.colwise().norm();
  for (Index j = 0; j < 2 * n; ++j) column(j) = column(j) > 0.0 ? column(j) : 1.0;
  rows.array().rowwise() /= column.transpose().array();
  const VectorXd v = smallest_singular_vector(rows).cwiseQuotient(column);
  r.alpha.resize(n);
  r.beta = v.tail(n);
  for (Index j = 0; j < n; ++j) r.alpha(j) = v(j) * f_(r.support[std_index(j)]);
}

Barycentric MagnitudeSquare::fit(int order) const {
  Barycentric r;
  // The first support point: where the curve is farthest from its mean.
  VectorXd error = f_.array().log() - f_.array().log().mean();
  VectorXd size = VectorXd::Ones(x_.size());
  while (std::ssize(r.support) < order + 1) {
    for (const Index i : r.support) error(i) = 0.0;
    Index worst = 0;
    error.cwiseAbs().maxCoeff(&worst);
    r.support.push_back(worst);
    solve(r, weight_);
    error = errors(r).error;
  }
  Barycentric best = r;
  double least = error.cwiseAbs().maxCoeff();
  VectorXd lawson = VectorXd::Ones(x_.size());
  for (int round = 0; round < kLawsonRounds; ++round) {
    const Errors now = errors(r);
    const double worst = now.error.cwiseAbs().maxCoeff();
    if (worst < least) {
      least = worst;
      best = r;
    }
    if (!(worst > 0.0)) break;
    lawson.array() *= now.error.array().abs() / worst + 1e-3;
    lawson /= lawson.maxCoeff();
    VectorXd row = lawson.cwiseSqrt().cwiseProduct(weight_);
    for (Index i = 0; i < row.size(); ++i) row(i) /= now.size(i) > 0.0 ? now.size(i) : 1.0;
    row /= row.maxCoeff();
    solve(r, row);
    if (!r.alpha.allFinite() || !r.beta.allFinite()) break;
  }
  return best;
}

/// Zeros of sum beta_j/(x - z_j): eigenvalues of Z - beta z'/sum(beta), all but one that is 0.
std::vector<Complex> roots_in_square(const VectorXd& z, const VectorXd& beta) {
  const Index n = beta.size();
  const double sum = beta.sum();
  if (!(std::abs(sum) > 0.0)) return {};
  // Scaled so that the matrix is as symmetric as it can be: z spans decades.
  VectorXd root(n);
  for (Index j = 0; j < n; ++j) root(j) = std::sqrt(std::abs(beta(j)) * z(j));
  MatrixXd m = -(root.array() * beta.array().sign()).matrix() * root.transpose() / sum;
  m.diagonal() += z;
  if (!m.allFinite()) return {};
  const Eigen::VectorXcd values = eigenvalues(m);
  if (values.size() != n) return {};
  std::vector<Complex> out(values.begin(), values.end());
  out.erase(std::ranges::min_element(
      out, [](const Complex& a, const Complex& b) { return std::abs(a) < std::abs(b); }));
  return out;
}

/// Corners of real roots, and pairs as (w0, zeta), both as logarithms.
struct LeftRoots {
  std::vector<double> real;
  std::vector<std::pair<double, double>> pairs;
};

/// Roots x = (w/reference)^2 as roots s with s^2 = -x in the left half plane.
LeftRoots left_roots(const std::vector<Complex>& x, double reference, double min_damping) {
  LeftRoots out;
  std::vector<double> on_axis;
  for (const Complex& root : x) {
    const double w0 = 0.5 * std::log(std::abs(root)) + std::log(reference);
    if (root.imag() > 0.0) {
      const Complex s = std::sqrt(-root);  // principal: right half plane
      out.pairs.emplace_back(w0, std::log(std::max(s.real() / std::abs(s), min_damping)));
    } else if (root.imag() == 0.0) {
      (root.real() <= 0.0 ? out.real : on_axis).push_back(w0);
    }
  }
  std::ranges::sort(on_axis);
  while (on_axis.size() >= 2) {
    const double last = on_axis.back();
    on_axis.pop_back();
    out.pairs.emplace_back(0.5 * (on_axis.back() + last), std::log(min_damping));
    on_axis.pop_back();
  }
  out.real.insert(out.real.end(), on_axis.begin(), on_axis.end());
  return out;
}

/// Their kinds changed until there are `reals` real ones: pairs part, neighbours pair.
bool take_kinds(LeftRoots& roots, std::size_t reals, std::size_t pairs) {
  while (roots.real.size() < reals && !roots.pairs.empty()) {
    const auto [w0, zeta] = roots.pairs.back();
    roots.pairs.pop_back();
    const double spread = zeta > 0.0 ? std::acosh(std::exp(zeta)) : 0.1;
    roots.real.push_back(w0 - spread);
    roots.real.push_back(w0 + spread);
  }
  std::ranges::sort(roots.real);
  while (roots.real.size() >= reals + 2) {
    const double b = roots.real.back();
    roots.real.pop_back();
    const double a = roots.real.back();
    roots.real.pop_back();
    roots.pairs.emplace_back(0.5 * (a + b), std::log(std::cosh(0.5 * (b - a)) + 1e-9));
  }
  return roots.real.size() == reals && roots.pairs.size() == pairs;
}

}  // namespace

double alternating_level(const std::vector<double>& errors, std::size_t count) {
  // The largest of every run of one sign.
  std::vector<double> peaks;
  for (const double e : errors) {
    if (e == 0.0) continue;
    if (peaks.empty() || (e > 0.0) != (peaks.back() > 0.0)) {
      peaks.push_back(e);
    } else if (std::abs(e) > std::abs(peaks.back())) {
      peaks.back() = e;
    }
  }
  const auto smaller = [](double a, double b) { return std::abs(a) < std::abs(b); };
  // Leave out the smallest: alone at an end, with its smaller neighbour inside, where the signs must go on alternating.
  while (peaks.size() > count) {
    const auto least = std::ranges::min_element(peaks, smaller);
    if (least == peaks.begin() || least + 1 == peaks.end()) {
      peaks.erase(least);
    } else if (peaks.size() == count + 1) {
      peaks.erase(smaller(peaks.front(), peaks.back()) ? peaks.begin() : peaks.end() - 1);
    } else {
      const auto neighbour = smaller(*(least - 1), *(least + 1)) ? least - 1 : least + 1;
      const auto first = std::min(least, neighbour);
      peaks.erase(first, first + 2);
    }
  }
  if (peaks.size() < count || peaks.empty()) return 0.0;
  return std::abs(*std::ranges::min_element(peaks, smaller));
}

double alternation_bound(const RootModel& model, const CurveTarget& target, const Eigen::VectorXd& theta) {
  Eigen::VectorXd error;
  curve_errors(model, target, theta, error, nullptr);
  const auto count = static_cast<std::size_t>(model.zeros() + model.poles() + 2);
  return alternating_level({error.data(), error.data() + error.size()}, count);
}

std::optional<VectorXd> rational_start(const RootModel& model, const CurveTarget& target,
                                       const RootLimits& limits) {
  if (target.has_phase() || std::ssize(target.frequency) < 2 * model.size()) return std::nullopt;
  const double reference = model.reference.value;
  const MagnitudeSquare curve(target, reference);
  const Barycentric r = curve.fit(model.poles());
  VectorXd z(r.beta.size());
  for (Index j = 0; j < z.size(); ++j) z(j) = curve.support_x(r.support[std_index(j)]);
  std::vector<Complex> zeros = roots_in_square(z, r.alpha);
  const std::vector<Complex> poles = roots_in_square(z, r.beta);
  // Fewer zeros than poles: those farthest out go.
  std::ranges::sort(zeros, [](const Complex& a, const Complex& b) { return std::abs(a) < std::abs(b); });
  const auto wanted = static_cast<std::size_t>(model.zeros());
  if (zeros.size() < wanted || std::ssize(poles) != model.poles()) return std::nullopt;
  if (wanted > 0 && wanted < zeros.size() && zeros[wanted - 1].imag() != 0.0 &&
      zeros[wanted] == std::conj(zeros[wanted - 1]))
    zeros[wanted - 1] = -std::abs(zeros[wanted - 1]);
  zeros.resize(wanted);
  LeftRoots z_roots = left_roots(zeros, reference, limits.min_damping);
  LeftRoots p_roots = left_roots(poles, reference, limits.min_damping);
  const auto count = [](int n) { return static_cast<std::size_t>(n); };
  if (!take_kinds(z_roots, count(model.real_zeros), count(model.zero_pairs)) ||
      !take_kinds(p_roots, count(model.real_poles), count(model.pole_pairs)))
    return std::nullopt;
  VectorXd theta(model.size());
  theta(0) = 0.0;
  Index at = 1;
  for (const LeftRoots* roots : {&z_roots, &p_roots}) {
    for (const double corner : roots->real) theta(at++) = corner;
    for (const auto& [w0, zeta] : roots->pairs) {
      theta(at++) = w0;
      theta(at++) = zeta;
    }
  }
  if (!theta.allFinite()) return std::nullopt;
  clamp(model, limits, theta);
  VectorXd level;
  RootResponse(model, theta).levels(target.frequency, level, nullptr);
  theta(0) = mean_log_gain(target) - as_eigen(target.weight).dot(level) / as_eigen(target.weight).sum();
  return theta;
}

}  // namespace bodesmith
