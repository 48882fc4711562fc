#include <cmath>

#include "fit/direct/direct_fit.hpp"
#include "lti/frequency_grid.hpp"
#include "tuning/controller_kind.hpp"

namespace bodesmith::tuning {
namespace {

/// C(s) = 1 + ki s^-lambda + kd s^mu/(1 + s/w_d) (I. Podlubny, IEEE Trans. Automatic Control 44 (1999) 208, its derivative
/// filtered); x = lg(ki/w_c^lambda), lg(kd w_c^mu), lambda, mu. Made as a PI, whose integral leaves no error at rest, times
/// sections fitted to what is left of C from 1/200 to 100 times the crossover.
class FractionalPid final : public ControllerKind {
 public:
  FractionalPid() : ControllerKind("fractional-pid", "integral and derivative of orders between 0 and 1.4") {}
  Bounds bounds(const ShapeSetting& setting) const override {
    return {Eigen::Vector4d(-3.0, -setting.decades(), 0.6, 0.3),
            Eigen::Vector4d(setting.decades(), 1.0, 1.4, 1.0)};
  }
  bool made_exactly() const override { return false; }
  Complex response(const SeriesController&, const Eigen::VectorXd& x, const ShapeSetting& setting,
                   Complex s) const override {
    const Complex ratio = s / setting.crossover.rad_s().value;
    return 1.0 + std::pow(10.0, x(0)) * std::pow(ratio, -x(2)) +
           std::pow(10.0, x(1)) * std::pow(ratio, x(3)) / (1.0 + s / setting.derivative_corner.rad_s().value);
  }
  SeriesController make(const Eigen::VectorXd& x, const ShapeSetting& setting) const override {
    SeriesController out;
    out.pid.proportional = 1.0;
    // Where |ki s^-lambda| = 1, the corner of the PI that takes its place.
    out.pid.integral_per_s = std::pow(10.0, x(0) / x(2)) * setting.crossover.rad_s().value;
    BodePoints rest;
    rest.file = "the fractional controller";
    constexpr int kPoints = 100;
    for (const Hertz f : log_grid(
             {Hertz{setting.crossover.value / 200.0}, Hertz{100.0 * setting.crossover.value}}, kPoints)) {
      const Complex s(0.0, f.rad_s().value);
      const Complex h = response(out, x, setting, s) / (1.0 + out.pid.integral_per_s / s);
      rest.points.push_back({f, std::abs(h), to_degrees(std::arg(h)), 1.0, 0});
    }
    DirectFitOptions options;
    options.use_phase = true;
    constexpr double kErrorDb = 0.05;  // half a degree at most: below what margins are asked to
    constexpr int kMostPoles = 7;
    out.filter = fit_directly_within(rest, options, kErrorDb, 4, kMostPoles).sections;
    out.filter.error.reset();
    return out;
  }
};

}  // namespace

BODESMITH_ENTRY(ControllerKind, fractional_pid_kind, FractionalPid)

}  // namespace bodesmith::tuning
