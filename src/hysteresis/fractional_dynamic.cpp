#include "hysteresis/fractional_dynamic.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "base/whole_number.hpp"
#include "numeric/linear_algebra/dense.hpp"

namespace bodesmith::hysteresis {
namespace {

Complex power(Complex s, double exponent) {
  if (s == Complex(0.0, 0.0)) return exponent == 0.0 ? 1.0 : 0.0;
  return std::exp(exponent * std::log(s));
}

/// F⁻¹ over the static gain, and the whole model alongside it to say what comes out.
class FractionalInverse final : public Inverse {
 public:
  explicit FractionalInverse(const FractionalDynamic& model)
      : model_(model), forward_(model), back_(inverse_of(model)) {}
  double reset(double y) override {
    time_ = 0.0;
    const double u = back_.reset(y - model_.delta);
    achieved_ = forward_.reset(u);
    return u;
  }
  double step(double y, double dt_s) override {
    time_ += dt_s;
    const double u = back_.step(y - model_.delta - model_.rho * time_, dt_s);
    achieved_ = forward_.step(u, dt_s);
    return u;
  }

 private:
  /// Numerator and denominator of F exchanged, with a lag and a resonance far above everything.
  static FractionalDynamic inverse_of(const FractionalDynamic& m) {
    FractionalDynamic out;
    out.k_p = 1.0;
    out.eta = m.lambda;
    out.theta = m.chi;
    out.lambda = m.eta;
    out.chi = m.theta / m.k_p;
    out.omega_n = 100.0 * std::max(m.omega_n, 1.0 / m.tau);
    out.xi = 0.7;
    out.tau = 0.01 * std::min(m.tau, 1.0 / m.omega_n);
    out.k_m = out.omega_n * out.omega_n / m.static_gain();
    out.modes = std::max(m.modes, 60);
    return out;
  }
  FractionalDynamic model_;
  FractionalOperator forward_;
  FractionalOperator back_;
  double time_ = 0.0;
};

class FractionalDynamicType final : public ShapedModelType<FractionalDynamic, FractionalOperator> {
 public:
  FractionalDynamicType()
      : ShapedModelType(
            "fractional_dynamic", "linear fractional hysteresis force with lag and resonance",
            {
                any_number("K_M", "1", "gain in front of the resonance"),
                between("xi", "1", "damping ratio of the resonance", 1e-6, 100.0),
                above_zero("omega_n", "rad/s", "natural frequency of the resonance"),
                above_zero("tau", "s", "time constant of amplifier and capacitance"),
                between("eta", "1", "order of the voltage's derivative", 1e-3, 0.999),
                between("lambda", "1", "order of the force's derivative", 1e-3, 0.999),
                above_zero("K_p", "1", "constant gain of the hysteresis force"),
                not_negative("Theta", "s^eta", "gain of the voltage's derivative"),
                not_negative("chi", "s^lambda", "gain of the force's derivative"),
                any_number("rho", "y/s", "slope of the linear compensator").with_default(0.0),
                any_number("delta", "y", "constant of the linear compensator").with_default(0.0),
                between("modes", "1", "first-order sections of the simulation", 8, 400).with_default(60),
            }) {}

  std::optional<Complex> response(const Parameters& values, Complex s) const override {
    return FractionalDynamic::from(values).response(s);
  }

 protected:
  std::unique_ptr<Inverse> inverse_of(const FractionalDynamic& model) const override {
    if (model.static_gain() == 0.0) throw DesignError("K_M is 0: there is no inverse");
    return std::make_unique<FractionalInverse>(model);
  }
  Identified fit(std::span<const TimeRecord> records, const IdentifyOptions& options) const override {
    return identify_fractional_dynamic(records, options);
  }
};

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
  for (std::size_t k = 0; k < lag_.size(); ++k) lag_[k] = u / spread_.sigma[k];
  const double z = spread_.response(0.0).real() * u;
  const double per_force = model_.k_m / (model_.omega_n * model_.omega_n);
  plant_ << z, per_force * z, 0.0;
  constant_ = per_force * (model_.k_p * u - z) + model_.delta;
  return plant_(1) + constant_;
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
  const auto solved = [](const Eigen::MatrixXd& m, const Eigen::VectorXd& right) {
    return solve_lu(m, right);
  };
  const Eigen::Vector3d g0 = solved(a, (plant_decay_ - Eigen::Matrix3d::Identity()) * b);
  const Eigen::Vector3d g1 = solved(a, g0 - dt_s * b) / dt_s;  // answer to t/h
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
    const Eigen::Vector3d g = solved(shifted, (plant_decay_ - decay_[k] * Eigen::Matrix3d::Identity()) * b);
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
  if (!(dt_s > 0.0)) {  // a jump, as to the first sample of a record that begins with all states zero
    u_ = u;
    return plant_(1) + model_.rho * time_ + constant_;
  }
  if (dt_s != prepared_) prepare(dt_s);
  Eigen::Vector3d plant;
  advance(u, dt_s, scratch_.data(), plant);
  lag_.swap(scratch_);
  plant_ = plant;
  u_ = u;
  time_ += dt_s;
  return plant_(1) + model_.rho * time_ + constant_;
}

double FractionalOperator::peek(double u, double dt_s) const {
  if (dt_s != prepared_ || !(dt_s > 0.0)) {
    FractionalOperator copy(*this);
    return copy.step(u, dt_s);
  }
  Eigen::Vector3d plant;
  advance(u, dt_s, scratch_.data(), plant);
  return plant(1) + model_.rho * (time_ + dt_s) + constant_;
}

FractionalPolynomial FractionalDynamic::denominator() const {
  const double damping = 2.0 * xi * omega_n;
  const double square = omega_n * omega_n;
  const double c[4] = {square, tau * square + damping, 1.0 + tau * damping, tau};
  FractionalPolynomial out;
  for (int i = 3; i >= 0; --i) {
    out.push_back({c[i] * chi, i + lambda});
    out.push_back({c[i], static_cast<double>(i)});
  }
  return out;
}

FractionalDynamic FractionalDynamic::from(const Parameters& values) {
  return {.k_m = values.number("K_M"),
          .xi = values.number("xi"),
          .omega_n = values.number("omega_n"),
          .tau = values.number("tau"),
          .eta = values.number("eta"),
          .lambda = values.number("lambda"),
          .k_p = values.number("K_p"),
          .theta = values.number("Theta"),
          .chi = values.number("chi"),
          .rho = values.number("rho"),
          .delta = values.number("delta"),
          .modes = whole_number<int>(values.number("modes"))};
}

BODESMITH_ENTRY(ModelType, fractional_dynamic_type, FractionalDynamicType)

namespace {

using std::numbers::pi;

/// Points in x = ln σ. The density of the lags has a pole near the axis at ln σ = −ln χ/λ ± iπ(1 − λ)/λ: the
/// nearer λ is to 1, the more it is one lag. Points are crowded there: their number up to x is
/// N(x) = x/h + c asinh((x − x_c)/d).
class CrowdedPoints {
 public:
  CrowdedPoints(const FractionalDynamic& model, double low, double high)
      : x_low_(std::log(low)), x_high_(std::log(high)) {
    const bool crowded = model.chi > 0.0;
    centre_ = crowded ? -std::log(model.chi) / model.lambda : 0.0;
    distance_ = crowded ? std::min(pi * (1.0 - model.lambda) / model.lambda, pi) : 1.0;
    c_ = crowded ? 3.0 : 0.0;
    if (extra() > 0.5 * model.modes) c_ *= 0.5 * model.modes / extra();
    h_ = (x_high_ - x_low_) / (model.modes - extra());
  }
  /// N(x).
  double number(double x) const { return x / h_ + c_ * std::asinh((x - centre_) / distance_); }
  double number_at_start() const { return number(x_low_); }
  /// 1/N'(x).
  double spacing(double x) const { return 1.0 / (1.0 / h_ + c_ / std::hypot(x - centre_, distance_)); }
  /// x with N(x) = n.
  double point(double n) const {
    double from = x_low_ - 2.0 * h_;
    double to = x_high_ + 2.0 * h_;
    for (int i = 0; i < 80 && to - from > 1e-13 * (1.0 + std::abs(from)); ++i) {
      const double middle = 0.5 * (from + to);
      (number(middle) < n ? from : to) = middle;
    }
    return 0.5 * (from + to);
  }

 private:
  double extra() const {
    return c_ * (std::asinh((x_high_ - centre_) / distance_) - std::asinh((x_low_ - centre_) / distance_));
  }
  double x_low_;
  double x_high_;
  double centre_;
  double distance_;
  double c_;
  double h_;
};

/// r(σ) = −(1/π) Im F(σ e^(iπ)).
double density(const FractionalDynamic& model, double sigma) {
  const Complex up = model.k_p + model.theta * std::polar(std::pow(sigma, model.eta), pi * model.eta);
  const Complex down = 1.0 + model.chi * std::polar(std::pow(sigma, model.lambda), pi * model.lambda);
  return -(up / down).imag() / pi;
}

}  // namespace

LagSpread LagSpread::of(const FractionalDynamic& model, double anchor) {
  const double slow = std::min(anchor, model.omega_n);
  const double fast = std::max(anchor, model.omega_n);
  const CrowdedPoints points(model, slow * 1e-8, fast * 1e5);
  const double at_anchor = points.number(std::log(anchor));
  const double first = std::ceil(points.number_at_start() - at_anchor - 0.5);
  LagSpread out;
  for (int k = 0; k < model.modes; ++k) {
    const double x = points.point(at_anchor + first + k + 0.5);
    out.sigma.push_back(std::exp(x));
    out.weight.push_back(density(model, out.sigma.back()) * points.spacing(x) * out.sigma.back());
  }
  // What lies below the first section is a constant to all that moves, what lies above the last one a slope: the constant and the
  // last section's weight are those with which F is exact at two places on the real axis.
  out.weight.back() = 0.0;
  const double low = 0.03 * slow;
  const double high = 3.0 * fast;
  const double last = out.sigma.back();
  const double left_low = (model.fractional_part(low) - out.response(low)).real();
  const double left_high = (model.fractional_part(high) - out.response(high)).real();
  out.weight.back() = (left_low - left_high) / (1.0 / (low + last) - 1.0 / (high + last));
  out.direct = left_low - out.weight.back() / (low + last);
  return out;
}

Complex LagSpread::response(Complex s) const {
  Complex sum = direct;
  for (std::size_t k = 0; k < sigma.size(); ++k) sum += weight[k] / (s + sigma[k]);
  return sum;
}

}  // namespace bodesmith::hysteresis
