#include <algorithm>
#include <cmath>

#include "schematic/elements/element.hpp"

namespace bodesmith::schematic {
namespace {

/// i = Is (exp(v/nVt) - 1), q = junction charge + transit i; shot noise 2 q (i + 2 Is), at rest 4 q Is, the thermal noise of
/// its slope (n = 1). The series resistance is left out: fractions of an ohm in circuits of kiloohms.
class Diode final : public Element {
 public:
  Diode(int anode, int cathode, const DiodeModel& model)
      : anode_(anode),
        cathode_(cathode),
        model_(model),
        vt_(model.emission * kBoltzmann * kKelvin / kElectron) {}

  void stamp(const Point& at, Stamps& to) const override {
    const double v = at[anode_] - at[cathode_];
    const double e = std::exp(std::clamp(v / vt_, -kMost, kMost));
    // Beyond the limit straight on, so that Newton's method finds back.
    const double g = model_.saturation_a * e / vt_;
    const double i = model_.saturation_a * (e - 1.0) + (v / vt_ > kMost ? g * (v - kMost * vt_) : 0.0);
    // The charge's own bend times dv/dt.
    const double bend = junction_slope(v) + (v / vt_ > kMost ? 0.0 : model_.transit_s * g / vt_);
    to.between(anode_, cathode_, i, junction_charge(v) + model_.transit_s * i,
               g + bend * (at.rate_of(anode_) - at.rate_of(cathode_)), junction_f(v) + model_.transit_s * g);
  }
  void noise(RadPerSecond, bool, NoiseSources& to) const override {
    to.add(anode_, cathode_, 4.0 * kElectron * model_.saturation_a);
  }

 private:
  static constexpr double kMost = 40.0;  ///< of v/vt: kiloamperes
  /// SPICE: C0/sqrt(1 - v), linear beyond half the built-in 1 V.
  double junction_f(double v) const {
    return v < 0.5 ? model_.junction_f / std::sqrt(1.0 - v)
                   : model_.junction_f / std::sqrt(0.5) * (1.0 + (v - 0.5));
  }
  double junction_slope(double v) const {
    return v < 0.5 ? 0.5 * model_.junction_f * std::pow(1.0 - v, -1.5) : model_.junction_f / std::sqrt(0.5);
  }
  double junction_charge(double v) const {
    const double c = model_.junction_f;
    if (v < 0.5) return 2.0 * c * (1.0 - std::sqrt(1.0 - v));
    const double beyond = v - 0.5;
    return 2.0 * c * (1.0 - std::sqrt(0.5)) + c / std::sqrt(0.5) * beyond * (1.0 + 0.5 * beyond);
  }

  int anode_, cathode_;
  DiodeModel model_;
  double vt_;
};

/// min(R i, -v) = 0, R for the volts of the other term.
class IdealDiode final : public Element {
 public:
  IdealDiode(int anode, int cathode, int branch) : anode_(anode), cathode_(cathode), branch_(branch) {}
  void stamp(const Point& at, Stamps& to) const override {
    to.add(anode_, at[branch_], 0.0);
    to.add(cathode_, -at[branch_], 0.0);
    to.slope(anode_, branch_, 1.0, 0.0);
    to.slope(cathode_, branch_, -1.0, 0.0);
    const double v = at[anode_] - at[cathode_], forward = kOhm * at[branch_];
    const bool blocks = forward < -v;
    to.add(branch_, blocks ? forward : -v, 0.0);
    to.slope(branch_, branch_, blocks ? kOhm : 0.0, 0.0);
    to.slope(branch_, anode_, blocks ? 0.0 : -1.0, 0.0);
    to.slope(branch_, cathode_, blocks ? 0.0 : 1.0, 0.0);
  }

 private:
  static constexpr double kOhm = 10e3;
  int anode_, cathode_, branch_;
};

}  // namespace

std::unique_ptr<Element> make_ideal_diode(int anode, int cathode, int branch) {
  return std::make_unique<IdealDiode>(anode, cathode, branch);
}

std::unique_ptr<Element> make_diode(int anode, int cathode, const DiodeModel& model) {
  return std::make_unique<Diode>(anode, cathode, model);
}

}  // namespace bodesmith::schematic
