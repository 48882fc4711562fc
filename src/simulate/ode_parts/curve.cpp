// y = f(u), no memory; an event at each corner of f.
#include "simulate/ode_parts/ode_part.hpp"

namespace bodesmith::simulate {
namespace {

class CurvePart final : public OdePart {
 public:
  explicit CurvePart(const chain::CurveKernel& curve) : curve_(curve), corners_(curve.corners()) {}

  std::size_t events() const override { return corners_.size(); }
  double start(double /*t*/, double u, bool /*still*/, double* /*x*/) override { return curve_.value(u); }
  std::optional<double> output(double /*t*/, double u, const double* /*x*/) const override {
    return curve_.value(u);
  }
  double newton(double /*gamma*/, double du, const double* /*x*/, double* /*z*/) override {
    return du * curve_.slope(in_.value);
  }
  void event_values(const double* /*x*/, double* g) const override {
    for (std::size_t i = 0; i < corners_.size(); ++i) g[i] = in_.value - corners_[i];
  }

 private:
  SlopedValue pass(double /*t*/, SlopedValue in, const double* /*x*/, double* /*dx*/,
                   Walk /*purpose*/) override {
    const double slope = in.slope != 0.0 ? in.slope * curve_.slope(in.value) : in.slope;
    return {curve_.value(in.value), slope};
  }

  const chain::CurveKernel& curve_;
  std::vector<double> corners_;
};

}  // namespace

std::unique_ptr<OdePart> make_curve_part(const chain::CurveKernel& curve) {
  return std::make_unique<CurvePart>(curve);
}

}  // namespace bodesmith::simulate
