#include <cmath>

#include "tuning/controller_kind.hpp"

namespace bodesmith::tuning {
namespace {

/// C(s) = 1 + ki/s + kd s/(1 + s/w_d); x = lg(ki/w_c), lg(kd w_c).
class Pid final : public ControllerKind {
 public:
  Pid() : ControllerKind("pid", "proportional, integral and filtered derivative") {}
  /// From an integral that hardly acts to one that does all, up to the highest frequency; the derivative from nothing there
  /// to ten times the rest.
  Bounds bounds(const ShapeSetting& setting) const override {
    return {Eigen::Vector2d(-3.0, -setting.decades()), Eigen::Vector2d(setting.decades(), 1.0)};
  }
  SeriesController make(const Eigen::VectorXd& x, const ShapeSetting& setting) const override {
    const double w = setting.crossover.rad_s().value;
    SeriesController out;
    out.pid.proportional = 1.0;
    out.pid.integral_per_s = std::pow(10.0, x(0)) * w;
    out.pid.derivative_s = std::pow(10.0, x(1)) / w;
    out.pid.derivative_corner = setting.derivative_corner;
    return out;
  }
};

}  // namespace

BODESMITH_ENTRY(ControllerKind, pid_kind, Pid)

}  // namespace bodesmith::tuning
