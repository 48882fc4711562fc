#include <cmath>

#include "synthesis/realisation.hpp"

namespace bodesmith::synthesis {
const Realisation& khn();

namespace {

/// Tow-Thomas two-integrator loop with the input fed forward to all three op-amps (Fleischer and Tow, Bell
/// Syst. Tech. J. 52, 1973), for any numerator. With u = +in or -in for each of the three feeds:
///   V1 = -(ua/Ra + V3/R2)/(s C1 + 1/Rq),  V2 = -(V1/R3 + ub/Rb)/(s C2),  V3 = -(Rr/Rs) V2 - (Rr/Rc) uc,  out
///   = V3.
/// With Rs = Rr:
///   H = -[K s^2 + (K a1 - B) s + (A - a1 B)] / [s^2 + a1 s + a0],
///   a1 = 1/(Rq C1), a0 = 1/(R2 R3 C1 C2), K = Rr/Rc, B = 1/(Rb C2), A = 1/(Ra R3 C1 C2);
/// a feed whose coefficient is 0 is absent, one whose coefficient is negative comes from an inverter of the
/// input. Without R2 the loop is open: a pole at 0 and one at a1, below any zeros (a PID's).
class TowThomas final : public StageForm {
 public:
  explicit TowThomas(const Section& section) {
    wanted_ = Biquad::from_section(negated(section));
    // Wanted numerator of -H: n2 s^2 + n1 s + n0.
    const double n2 = -wanted_.b2, n1 = -wanted_.b1, n0 = -wanted_.b0;
    a1_ = wanted_.a1;
    a0_ = wanted_.a0;
    integrates_ = a0_ == 0.0;
    w0_ = integrates_ ? a1_ : std::sqrt(a0_);
    const double scale = std::abs(n2) + std::abs(n1) / w0_ + std::abs(n0) / (w0_ * w0_);
    const auto clean = [&](double value, double size) {
      return std::abs(value) < 1e-12 * size ? 0.0 : value;
    };
    k_ = n2;
    b_ = clean(k_ * a1_ - n1, scale * (w0_ + a1_));
    a_ = clean(n0 + a1_ * b_, scale * (a0_ + a1_ * a1_));
    if (k_ < 0.0 || b_ < 0.0 || a_ < 0.0) {
      resistor("Ri", "in", "k");
      resistor("Rj", "k", "n");
      opamp("U4", "0", "k", "n");
      has_inverter_ = true;
    }
    const auto feed = [](double value) { return value < 0.0 ? "n" : "in"; };
    if (a_ != 0.0) resistor("Ra", feed(a_), "m1");
    if (b_ != 0.0) resistor("Rb", feed(b_), "m2");
    if (k_ != 0.0) resistor("Rc", feed(k_), "m3");
    resistor("Rq", "m1", "v1");
    if (!integrates_) resistor("R2", "out", "m1");
    resistor("R3", "v1", "m2");
    resistor("Rs", "v2", "m3");
    resistor("Rr", "m3", "out");
    capacitor("C1", "m1", "v1", {w0_});
    capacitor("C2", "m2", "v2", {w0_});
    opamp("U1", "0", "m1", "v1");
    opamp("U2", "0", "m2", "v2");
    opamp("U3", "0", "m3", "out");
  }

  Biquad transfer(std::span<const double> v) const override {
    std::size_t i = 0;
    const double inverted = has_inverter_ ? -v[1] / v[0] : 0.0;
    if (has_inverter_) i = 2;
    const auto feed = [&](double coefficient) {
      if (coefficient == 0.0) return 0.0;
      return (coefficient < 0.0 ? inverted : 1.0) / v[i++];
    };
    const double ga = feed(a_), gb = feed(b_), gc = feed(k_);
    const double rq = v[i++];
    const double g2 = integrates_ ? 0.0 : 1.0 / v[i++];
    const double r3 = v[i], rs = v[i + 1], rr = v[i + 2], c1 = v[i + 3], c2 = v[i + 4];
    // Multiplied out from the four node equations, with ratio m = Rr/Rs.
    const double m = rr / rs;
    const double p = 1.0 / (rq * c1);
    const double q = 1.0 / (c1 * c2);
    Biquad h{.a0 = m * q * g2 / r3, .a1 = p, .a2 = 1.0};
    const double k = rr * gc;
    const double b = m * gb / c2;
    h.b2 = -k;
    h.b1 = -(k * p - b);
    h.b0 = -(m * ga * q / r3 - p * b);
    return h;
  }

  std::optional<std::vector<double>> design(std::span<const double> c) const override {
    const double c1 = c[0], c2 = c[1];
    const double r = 1.0 / (w0_ * std::sqrt(c1 * c2));
    const double rs = r < 5e3 ? 5e3 : (r > 50e3 ? 50e3 : r);
    std::vector<double> values;
    if (has_inverter_) {
      values.push_back(20e3);
      values.push_back(20e3);
    }
    if (a_ != 0.0) values.push_back(1.0 / (std::abs(a_) * r * c1 * c2));
    if (b_ != 0.0) values.push_back(1.0 / (std::abs(b_) * c2));
    if (k_ != 0.0) values.push_back(rs / std::abs(k_));
    values.push_back(1.0 / (a1_ * c1));
    if (!integrates_) values.push_back(r);
    for (const double value : {r, rs, rs, c1, c2}) values.push_back(value);
    return values;
  }

 private:
  double a1_ = 0.0, a0_ = 0.0;
  double w0_ = 0.0;  ///< of the poles; of the one that is not at 0
  bool integrates_ = false;
  double k_ = 0.0, b_ = 0.0, a_ = 0.0;
  bool has_inverter_ = false;
};

class TowThomasRealisation final : public StageRealisation {
 public:
  std::string_view name() const override { return "tow-thomas"; }
  int bid(const Section& section) const override { return refusal(section) ? 0 : 1; }
  /// Zeros far from the poles are small differences here; KHN makes them by sums.
  const StageRealisation* fallback() const override { return khn().stage_realisation(); }
  std::optional<Refusal> refusal(const Section& section) const override {
    if (section.poles.size() != 2) return Refusal{"it makes two poles"};
    if (section.poles[0] == 0.0 && section.poles[1] == 0.0) return Refusal{"it makes one pole at 0"};
    return std::nullopt;
  }
  std::unique_ptr<StageForm> make(const Section& section, const FormOptions&) const override {
    return std::make_unique<TowThomas>(section);
  }
};

}  // namespace

BODESMITH_ENTRY(Realisation, tow_thomas, TowThomasRealisation)

}  // namespace bodesmith::synthesis
