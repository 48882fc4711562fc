#include <cmath>

#include "schematic/elements/element.hpp"

namespace bodesmith::schematic {
namespace {

/// The stage behind the inputs holds y = V(out) + Ro i; with d = V(plus) + offset - V(minus)
///   1/GBW dy/dt = (slew/GBW) tanh(GBW d/slew) - y/A0 - what a limit at +-swing takes away,
/// for small signals A(s) d = y with A = A0/(1 + s A0/GBW). Noise: en and that of Ro, divided by A, in series with the
/// inputs; in at each of them.
class RealOpAmp final : public Element {
 public:
  RealOpAmp(const Inputs& at, int branch, const OpAmpModel& model, double offset_v)
      : at_(at), branch_(branch), model_(model), offset_v_(offset_v) {}

  void stamp(const Point& p, Stamps& to) const override {
    const double gbw = model_.gain_bandwidth.rad_s().value, slew = model_.slew_v_per_s,
                 ro = model_.output_resistance_ohm;
    to.add(at_.out, -p[branch_], 0.0);  // its current flows into the node
    to.slope(at_.out, branch_, -1.0, 0.0);
    const double y = p[at_.out] + ro * p[branch_];
    const double driven = std::tanh(gbw / slew * (p[at_.plus] + offset_v_ - p[at_.minus]));
    const double beyond = y > model_.swing_v    ? y - model_.swing_v
                          : y < -model_.swing_v ? y + model_.swing_v
                                                : 0.0;
    const double clamp = slew / kClampV / gbw;
    to.add(branch_, slew / gbw * driven - y / model_.dc_gain - clamp * beyond, -y / gbw);
    const double by_input = 1.0 - driven * driven,
                 by_y = -1.0 / model_.dc_gain - (beyond != 0.0 ? clamp : 0.0);
    to.slope(branch_, at_.plus, by_input, 0.0);
    to.slope(branch_, at_.minus, -by_input, 0.0);
    to.slope(branch_, at_.out, by_y, -1.0 / gbw);
    to.slope(branch_, branch_, by_y * ro, -ro / gbw);
  }

  void noise(RadPerSecond w, bool flicker, NoiseSources& to) const override {
    const double factor = flicker ? 1.0 + model_.voltage_noise_corner_hz / w.hz().value : 1.0;
    const double voltage = std::pow(model_.voltage_noise_v_per_rthz, 2) * factor;
    const double resistance =
        4.0 * kBoltzmann * kKelvin * model_.output_resistance_ohm / std::norm(model_.open_loop(w));
    to.add(branch_, kGround, voltage + resistance);
    const double current = std::pow(model_.current_noise_a_per_rthz, 2);
    to.add(at_.plus, kGround, current);
    to.add(at_.minus, kGround, current);
  }

 private:
  static constexpr double kClampV = 1e-3;  ///< beyond the swing that takes the whole slewing current
  Inputs at_;
  int branch_;
  OpAmpModel model_;
  double offset_v_;
};

class Nullor final : public Element {
 public:
  Nullor(const Inputs& at, int branch, double offset_v) : at_(at), branch_(branch), offset_v_(offset_v) {}
  void stamp(const Point& p, Stamps& to) const override {
    to.add(at_.out, -p[branch_], 0.0);
    to.slope(at_.out, branch_, -1.0, 0.0);
    to.add(branch_, p[at_.plus] + offset_v_ - p[at_.minus], 0.0);
    to.slope(branch_, at_.plus, 1.0, 0.0);
    to.slope(branch_, at_.minus, -1.0, 0.0);
  }

 private:
  Inputs at_;
  int branch_;
  double offset_v_;
};

}  // namespace

std::unique_ptr<Element> make_opamp(const Inputs& at, int branch, const OpAmpModel& model, double offset_v) {
  return std::make_unique<RealOpAmp>(at, branch, model, offset_v);
}

std::unique_ptr<Element> make_nullor(const Inputs& at, int branch, double offset_v) {
  return std::make_unique<Nullor>(at, branch, offset_v);
}

}  // namespace bodesmith::schematic
