#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "hysteresis/fractional_dynamic.hpp"

namespace bodesmith::hysteresis {
namespace {

using std::numbers::pi;

/// Points in x = ln σ. The density of the lags has a pole beside the axis at ln σ = −ln χ/λ ± iπ(1 − λ)/λ: the
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

/// From where F is still its constant to where it is its own tail: eight decades either side of the corners,
/// and of the lag and the resonance, which see the middle of it.
CrowdedPoints points_of(const FractionalDynamic& model, double anchor) {
  double low = std::min(anchor, model.omega_n);
  double high = std::max(anchor, model.omega_n);
  const auto corner = [&](double coefficient, double exponent) {
    if (!(coefficient > 0.0)) return;
    const double at = std::pow(coefficient, -1.0 / exponent);
    low = std::min(low, std::max(at, 1e-9 * model.omega_n));
    high = std::max(high, std::min(at, 1e9 * model.omega_n));
  };
  corner(model.chi, model.lambda);
  corner(model.theta / model.k_p, model.eta);
  return {model, low * 1e-5, high * 1e3};
}

/// r(σ) = −(1/π) Im F(σ e^(iπ)).
double density(const FractionalDynamic& model, double sigma) {
  const std::complex<double> up =
      model.k_p + model.theta * std::polar(std::pow(sigma, model.eta), pi * model.eta);
  const std::complex<double> down =
      1.0 + model.chi * std::polar(std::pow(sigma, model.lambda), pi * model.lambda);
  return -(up / down).imag() / pi;
}

}  // namespace

LagSpread LagSpread::of(const FractionalDynamic& model, double anchor) {
  const CrowdedPoints points = points_of(model, anchor);
  const double at_anchor = points.number(std::log(anchor));
  const double first = std::ceil(points.number_at_start() - at_anchor - 0.5);
  LagSpread out;
  out.direct = model.k_p;
  for (int k = 0; k < model.modes; ++k) {
    const double x = points.point(at_anchor + first + k + 0.5);
    const double sigma = std::exp(x);
    const double r = density(model, sigma) * points.spacing(x);
    out.sigma.push_back(sigma);
    out.weight.push_back(r * sigma);
    out.direct -= r;
  }
  // What lies below the first section moves too slowly to follow anything: only its constant. Its density
  // falls with the smaller exponent.
  const double exponent = model.chi > 0.0 && model.theta != 0.0 ? std::min(model.eta, model.lambda)
                          : model.chi > 0.0                     ? model.lambda
                                                                : model.eta;
  const double edge = std::exp(points.point(at_anchor + first));
  out.direct -= density(model, edge) / exponent;
  return out;
}

std::complex<double> LagSpread::response(std::complex<double> s) const {
  std::complex<double> sum = direct;
  for (std::size_t k = 0; k < sigma.size(); ++k) sum += weight[k] / (s + sigma[k]);
  return sum;
}

}  // namespace bodesmith::hysteresis
