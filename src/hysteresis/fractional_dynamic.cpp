#include "hysteresis/fractional_dynamic.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/error.hpp"
#include "base/whole_number.hpp"
#include "numeric/dense.hpp"
#include "numeric/grunwald_letnikov.hpp"
#include "numeric/matrix_exponential.hpp"

namespace bodesmith::hysteresis {
namespace {

constexpr double kPi = std::numbers::pi;
using Complex = std::complex<double>;

Complex power(Complex s, double exponent) {
  if (s == Complex(0.0, 0.0)) return exponent == 0.0 ? 1.0 : 0.0;
  return std::exp(exponent * std::log(s));
}

}  // namespace

Complex FractionalDynamic::fractional_part(Complex s) const {
  return (k_p + theta * power(s, eta)) / (1.0 + chi * power(s, lambda));
}

Complex FractionalDynamic::response(Complex s) const {
  return k_m / ((tau * s + 1.0) * (s * s + 2.0 * xi * omega_n * s + omega_n * omega_n)) * fractional_part(s);
}

FractionalOperator::FractionalOperator(const FractionalDynamic& model)
    : model_(model), spread_(LagSpread::of(model, 1.0 / model.tau)) {
  const std::size_t n = spread_.sigma.size();
  lag_.assign(n, 0.0);
  scratch_.assign(n, 0.0);
  decay_.assign(n, 0.0);
  hold_0_.assign(n, 0.0);
  hold_1_.assign(n, 0.0);
  from_lag_ = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(n));
  reset(0.0);
}

double FractionalOperator::reset(double u) {
  u_ = u;
  time_ = 0.0;
  double z = spread_.direct * u;
  for (std::size_t k = 0; k < lag_.size(); ++k) {
    lag_[k] = u / spread_.sigma[k];
    z += spread_.weight[k] * lag_[k];
  }
  plant_ << z, model_.k_m * z / (model_.omega_n * model_.omega_n), 0.0;
  return plant_(1) + model_.delta;
}

void FractionalOperator::prepare(double dt_s) {
  prepared_ = dt_s;
  // w' = (z − w)/τ, v' = p, p' = K_M w − ω² v − 2ξω p.
  Eigen::Matrix3d a;
  a << -1.0 / model_.tau, 0.0, 0.0, 0.0, 0.0, 1.0, model_.k_m, -model_.omega_n * model_.omega_n,
      -2.0 * model_.xi * model_.omega_n;
  const Eigen::Vector3d b(1.0 / model_.tau, 0.0, 0.0);
  // Velocity over ω_n as the third state: the exponential then sees numbers of one size.
  const Eigen::Vector3d size(1.0, 1.0, model_.omega_n);
  const Eigen::Vector3d per_size = size.cwiseInverse();
  const Eigen::MatrixXd even = per_size.asDiagonal() * (a * dt_s) * size.asDiagonal();
  plant_decay_ = size.asDiagonal() * Eigen::Matrix3d(matrix_exponential(even)) * per_size.asDiagonal();
  // Constant and ramp inputs: a g0 = (e^{ah} − 1) b, a g1 = (g0 − h b)/h.
  const Eigen::PartialPivLU<Eigen::Matrix3d> lu(a);
  const Eigen::Vector3d g0 = lu.solve((plant_decay_ - Eigen::Matrix3d::Identity()) * b);
  const Eigen::Vector3d g1 = lu.solve(g0 - dt_s * b) / dt_s;  // answer to t/h
  input_0_ = spread_.direct * g0;
  input_1_ = spread_.direct * g1;
  for (std::size_t k = 0; k < lag_.size(); ++k) {
    const double sigma = spread_.sigma[k];
    const double x = sigma * dt_s;
    decay_[k] = std::exp(-x);
    hold_0_[k] = -std::expm1(-x) / sigma;
    hold_1_[k] = x > 1e-3 ? (dt_s - hold_0_[k]) / x : dt_s * (0.5 - x * (1.0 / 6.0 - x / 24.0));
    // ∫ e^{a(h−t)} b e^{−σt} dt.
    const Eigen::Matrix3d shifted = a + sigma * Eigen::Matrix3d::Identity();
    const Eigen::Vector3d g =
        shifted.partialPivLu().solve((plant_decay_ - decay_[k] * Eigen::Matrix3d::Identity()) * b);
    from_lag_.col(static_cast<Eigen::Index>(k)) = spread_.weight[k] * g;
    // A section's forced part: (1 − e^{−σt})/σ for the constant, (t − (1 − e^{−σt})/σ)/(σ h) for the ramp.
    const double w = spread_.weight[k] / sigma;
    input_0_ += w * (g0 - g);
    input_1_ += w * (g1 - (g0 - g) / x);
  }
}

void FractionalOperator::advance(double u, double dt_s, double* lags, Eigen::Vector3d& plant) const {
  (void)dt_s;
  const double rise = u - u_;
  double a = 0.0, b = 0.0, c = 0.0;
  const double* row = from_lag_.data();
  for (std::size_t k = 0; k < lag_.size(); ++k, row += 3) {
    const double x = lag_[k];
    a += row[0] * x;
    b += row[1] * x;
    c += row[2] * x;
    lags[k] = decay_[k] * x + hold_0_[k] * u_ + hold_1_[k] * rise;
  }
  plant = plant_decay_ * plant_ + Eigen::Vector3d(a, b, c) + input_0_ * u_ + input_1_ * rise;
}

double FractionalOperator::step(double u, double dt_s) {
  if (!(dt_s > 0.0)) return plant_(1) + model_.rho * time_ + model_.delta;
  if (dt_s != prepared_) prepare(dt_s);
  Eigen::Vector3d plant;
  advance(u, dt_s, scratch_.data(), plant);
  lag_.swap(scratch_);
  plant_ = plant;
  u_ = u;
  time_ += dt_s;
  return plant_(1) + model_.rho * time_ + model_.delta;
}

double FractionalOperator::peek(double u, double dt_s) const {
  if (dt_s != prepared_ || !(dt_s > 0.0)) {
    FractionalOperator copy(*this);
    return copy.step(u, dt_s);
  }
  Eigen::Vector3d plant;
  advance(u, dt_s, scratch_.data(), plant);
  return plant(1) + model_.rho * (time_ + dt_s) + model_.delta;
}

std::vector<double> simulate_grunwald_letnikov(const FractionalDynamic& model, const std::vector<double>& u,
                                               double step_s, int refine) {
  const auto parts = static_cast<std::size_t>(refine);
  const double h = step_s / refine;
  const std::vector<double> fine = straight_between(u, parts);
  const auto weights = [&](const FractionalPolynomial& polynomial) {
    std::vector<double> out(fine.size(), 0.0);
    for (const FractionalPolynomial::Term& term : polynomial.terms)
      add_difference_weights(term.coefficient * std::pow(h, -term.exponent), term.exponent, out);
    return out;
  };
  const std::vector<double> a = weights(FractionalPolynomial::denominator(model));
  const std::vector<double> b =
      weights({{{model.k_m * model.k_p, 0.0}, {model.k_m * model.theta, model.eta}}});
  std::vector<double> y(fine.size());
  for (std::size_t i = 0; i < y.size(); ++i) {
    double sum = sum_over_past(b, fine, i);
    for (std::size_t j = 1; j <= i; ++j) sum -= a[j] * y[i - j];
    y[i] = sum / a[0];
  }
  std::vector<double> out(u.size());
  for (std::size_t i = 0; i < u.size(); ++i)
    out[i] = y[i * parts] + model.rho * step_s * static_cast<double>(i) + model.delta;
  return out;
}

Complex FractionalPolynomial::operator()(Complex s) const {
  Complex sum = 0.0;
  for (const Term& term : terms) sum += term.coefficient * power(s, term.exponent);
  return sum;
}

FractionalPolynomial FractionalPolynomial::denominator(const FractionalDynamic& m) {
  const double damping = 2.0 * m.xi * m.omega_n;
  const double square = m.omega_n * m.omega_n;
  const double c[4] = {square, m.tau * square + damping, 1.0 + m.tau * damping, m.tau};
  FractionalPolynomial out;
  for (int i = 3; i >= 0; --i) {
    out.terms.push_back({c[i] * m.chi, i + m.lambda});
    out.terms.push_back({c[i], static_cast<double>(i)});
  }
  return out;
}

int right_half_plane_roots(const FractionalPolynomial& polynomial) {
  double top = 0.0;
  double bottom = std::numeric_limits<double>::infinity();
  double top_coefficient = 0.0;
  double bottom_coefficient = 0.0;
  for (const FractionalPolynomial::Term& term : polynomial.terms) {
    if (term.coefficient == 0.0) continue;
    if (term.exponent >= top) {
      top = term.exponent;
      top_coefficient = term.coefficient;
    }
    if (term.exponent <= bottom) {
      bottom = term.exponent;
      bottom_coefficient = term.coefficient;
    }
  }
  if (!(top > 0.0)) return 0;
  // Bounds between which everything happens: outside them the first or the last term dominates by far.
  double low = std::numeric_limits<double>::infinity();
  double high = 0.0;
  for (const FractionalPolynomial::Term& term : polynomial.terms) {
    if (term.coefficient == 0.0) continue;
    if (term.exponent > bottom)
      low = std::min(low, std::pow(1e-6 * std::abs(bottom_coefficient / term.coefficient),
                                   1.0 / (term.exponent - bottom)));
    if (term.exponent < top)
      high = std::max(
          high, std::pow(1e6 * std::abs(term.coefficient / top_coefficient), 1.0 / (top - term.exponent)));
  }
  if (high <= low) high = low * 10.0;
  // Argument along jω, ω from low to high, in steps small enough that each turns by less than a tenth of a
  // turn.
  const auto at = [&](double x) { return polynomial(Complex(0.0, std::exp(x))); };
  double x = std::log(low);
  const double end = std::log(high);
  Complex here = at(x);
  double turned =
      std::arg(here * std::conj(Complex(bottom_coefficient, 0.0) * power(Complex(0.0, 1.0), bottom)));
  double step = 0.05;
  while (x < end) {
    const double dx = std::min(step, end - x);
    const Complex next = at(x + dx);
    const double turn = std::arg(next * std::conj(here));
    if (std::abs(turn) > 0.6) {
      if (dx < 1e-9) return -1;
      step = 0.5 * dx;
      continue;
    }
    turned += turn;
    x += dx;
    here = next;
    if (std::abs(turn) < 0.1) step = std::min(0.05, 1.5 * dx);
  }
  // From 0 to ∞ the argument would turn by (top − bottom)π/2 without roots to the right; each takes π away.
  return nearest_whole<int>(((top - bottom) * kPi / 2.0 - turned) / kPi);
}

int unstable_by_matignon(const FractionalPolynomial& polynomial, double q) {
  std::vector<double> c;
  for (const FractionalPolynomial::Term& term : polynomial.terms) {
    const double degree = term.exponent / q;
    const auto whole = nearest_whole<std::size_t>(degree);
    if (std::abs(degree - static_cast<double>(whole)) > 1e-6)
      throw DesignError("an exponent is no multiple of q");
    if (whole > 600)
      throw DesignError("the degree in s^q is above 600: count by the argument principle instead");
    if (c.size() <= whole) c.resize(whole + 1, 0.0);
    c[whole] += term.coefficient;
  }
  while (!c.empty() && c.back() == 0.0) c.pop_back();
  const auto n = static_cast<Eigen::Index>(c.size()) - 1;
  if (n < 1) return 0;
  // Scaled so that the first and the last coefficient are alike.
  const double scale = std::pow(std::abs(c.front() / c.back()), 1.0 / static_cast<double>(n));
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i + 1 < n; ++i) companion(i + 1, i) = 1.0;
  for (Eigen::Index i = 0; i < n; ++i)
    companion(i, n - 1) =
        -c[static_cast<std::size_t>(i)] / c.back() * std::pow(scale, static_cast<double>(i - n));
  const Eigen::VectorXcd roots = eigenvalues(companion);
  int out = 0;
  for (Eigen::Index i = 0; i < roots.size(); ++i) out += std::abs(std::arg(roots(i))) < q * kPi / 2.0;
  return out;
}

}  // namespace bodesmith::hysteresis
