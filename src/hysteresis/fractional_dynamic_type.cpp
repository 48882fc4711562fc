#include <algorithm>

#include "base/error.hpp"
#include "base/whole_number.hpp"
#include "hysteresis/fractional_dynamic.hpp"
#include "hysteresis/identification.hpp"

namespace bodesmith::hysteresis {
namespace {

/// F⁻¹ over the static gain, and the whole model beside it to say what comes out.
class FractionalInverse final : public Inverse {
 public:
  explicit FractionalInverse(const FractionalDynamic& model)
      : model_(model), forward_(model), back_(inverse_of(model)) {}
  std::unique_ptr<Inverse> clone() const override { return std::make_unique<FractionalInverse>(*this); }
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
  double achieved() const override { return achieved_; }

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
  double achieved_ = 0.0;
};

class FractionalDynamicType final : public ShapedModelType<FractionalDynamic> {
 public:
  FractionalDynamicType()
      : ShapedModelType(
            "fractional_dynamic", "linear fractional hysteresis force with lag and resonance",
            "A Novel Fractional Order Model for the Dynamic Hysteresis of Piezoelectrically Actuated Fast Tool Servo, eq. 8-19",
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

  std::optional<std::complex<double>> response(const Parameters& values,
                                               std::complex<double> s) const override {
    return FractionalDynamic::from(values).response(s);
  }

 protected:
  std::unique_ptr<Operator> operator_of(const FractionalDynamic& model) const override {
    return std::make_unique<FractionalOperator>(model);
  }
  std::unique_ptr<Inverse> inverse_of(const FractionalDynamic& model) const override {
    if (model.static_gain() == 0.0) throw DesignError("K_M is 0: there is no inverse");
    return std::make_unique<FractionalInverse>(model);
  }
  Identified fit(std::span<const TimeRecord> records, const IdentifyOptions& options) const override {
    return identify_fractional_dynamic(records, options);
  }
};

}  // namespace

FractionalDynamic FractionalDynamic::from(const Parameters& values) {
  FractionalDynamic out;
  out.k_m = values.number("K_M");
  out.xi = values.number("xi");
  out.omega_n = values.number("omega_n");
  out.tau = values.number("tau");
  out.eta = values.number("eta");
  out.lambda = values.number("lambda");
  out.k_p = values.number("K_p");
  out.theta = values.number("Theta");
  out.chi = values.number("chi");
  out.rho = values.number("rho");
  out.delta = values.number("delta");
  out.modes = whole_number<int>(values.number("modes"));
  return out;
}

const ModelType& fractional_dynamic_type() {
  static const FractionalDynamicType type;
  return type;
}

}  // namespace bodesmith::hysteresis
