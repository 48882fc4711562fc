#include <algorithm>
#include <array>
#include <cmath>

#include "synthesis/realisation.hpp"

namespace bodesmith::synthesis {
namespace {

/// Kerwin-Huelsman-Newcomb state-variable filter (IEEE J. Solid-State Circuits SC-2, 1967) with a summing
/// output amplifier that makes the zeros. With t1 = R1 C1, t2 = R2 C2, r = R4/R3, F = 1 + r, alpha = R5/(R5 +
/// R6):
///   high-pass  h = F (1 - alpha) s^2 t1 t2/(s^2 t1 t2 + F alpha t2 s + r) in,  band-pass b = -h/(s t1),
///   low-pass l = -b/(s t2),  out = gh h + gb b + gl l with gains of either sign (parts/summing_amplifier.hpp).
class Khn final : public StageForm {
 public:
  explicit Khn(const Section& section) {
    wanted_ = Biquad::from_section(negated(section));
    a1_ = wanted_.a1;
    a0_ = wanted_.a0;
    // alpha = a1/(2 w1) has to stay below 1.
    w1_ = std::max(std::sqrt(a0_), 0.75 * a1_);
    w2_ = a0_ / w1_;
    alpha_ = a1_ / (2.0 * w1_);
    const double k = 2.0 * (1.0 - alpha_);
    gains_ = {wanted_.b2 / k, -wanted_.b1 / (k * w1_), wanted_.b0 / (k * a0_)};
    minus_ = plus_ = 0.0;
    for (const double g : gains_) (g < 0.0 ? minus_ : plus_) += std::abs(g);
    const double lack = 1.0 + minus_ - plus_;
    balance_at_plus_ = lack > 0.0;
    balance_ = plus_ > 0.0 && std::abs(lack) > 1e-9 ? std::abs(lack) : 0.0;

    resistor("R3", "l", "m1");
    resistor("R4", "m1", "h");
    resistor("R5", "in", "p1");
    resistor("R6", "p1", "b");
    resistor("R1", "h", "m2");
    resistor("R2", "b", "m3");
    static const char* const names[] = {"Rh", "Rb", "Rl"};
    static const char* const nodes[] = {"h", "b", "l"};
    for (std::size_t i = 0; i < 3; ++i) {
      if (gains_[i] != 0.0) resistor(names[i], nodes[i], gains_[i] < 0.0 ? "m4" : "p4");
    }
    resistor("Rf", "m4", "out");
    if (balance_ > 0.0) resistor("Rg", balance_at_plus_ ? "p4" : "m4", "0");
    capacitor("C1", "m2", "b", {w1_});
    capacitor("C2", "m3", "l", {w2_});
    opamp("U1", "p1", "m1", "h");
    opamp("U2", "0", "m2", "b");
    opamp("U3", "0", "m3", "l");
    opamp("U4", plus_ > 0.0 ? "p4" : "0", "m4", "out");
  }

  Biquad transfer(std::span<const double> v) const override {
    const double r = v[1] / v[0], f = 1.0 + r, alpha = v[2] / (v[2] + v[3]);
    std::size_t i = 6;
    double g_minus = 0.0, g_plus = 0.0, weight[3] = {};
    for (std::size_t k = 0; k < 3; ++k) {
      if (gains_[k] == 0.0) continue;
      weight[k] = 1.0 / v[i++];
      (gains_[k] < 0.0 ? g_minus : g_plus) += weight[k];
    }
    const double rf = v[i++];
    if (balance_ > 0.0) (balance_at_plus_ ? g_plus : g_minus) += 1.0 / v[i++];
    const double t1 = v[4] * v[i], t2 = v[5] * v[i + 1];
    const auto gain = [&](std::size_t k) {
      if (gains_[k] == 0.0) return 0.0;
      return gains_[k] < 0.0 ? -rf * weight[k] : weight[k] / g_plus * (1.0 + rf * g_minus);
    };
    const double scale = f * (1.0 - alpha);
    return {.b0 = scale * gain(2),
            .b1 = -scale * gain(1) * t2,
            .b2 = scale * gain(0) * t1 * t2,
            .a0 = r,
            .a1 = f * alpha * t2,
            .a2 = t1 * t2};
  }

  std::optional<std::vector<double>> design(std::span<const double> c) const override {
    const double r6 = alpha_ < 0.5 ? kLevel : kLevel * (1.0 - alpha_) / alpha_;
    const double r5 = r6 * alpha_ / (1.0 - alpha_);
    std::vector<double> values = {kLevel, kLevel, r5, r6, 1.0 / (w1_ * c[0]), 1.0 / (w2_ * c[1])};
    // The largest gain has the smallest resistor.
    const double rf =
        std::max(kLevel, 2e3 * std::max({std::abs(gains_[0]), std::abs(gains_[1]), std::abs(gains_[2])}));
    for (const double g : gains_) {
      if (g != 0.0) values.push_back(rf / std::abs(g));
    }
    values.push_back(rf);
    if (balance_ > 0.0) values.push_back(rf / balance_);
    values.push_back(c[0]);
    values.push_back(c[1]);
    return values;
  }

 private:
  static constexpr double kLevel = 20e3;
  double a1_ = 0.0, a0_ = 0.0, w1_ = 0.0, w2_ = 0.0, alpha_ = 0.0;
  std::array<double, 3> gains_{};
  double minus_ = 0.0, plus_ = 0.0, balance_ = 0.0;
  bool balance_at_plus_ = true;
};

class KhnRealisation final : public StageRealisation {
 public:
  std::string_view name() const override { return "khn"; }
  /// High-passes of high Q: its loop is less sensitive than Sallen and Key's.
  int bid(const Section& section) const override {
    return is_high_pass(section) && quality_of(section) > kSallenKeyMaxQuality ? 2 : 0;
  }
  std::optional<Refusal> refusal(const Section& section) const override {
    if (section.poles.size() == 2 && !integrates(section)) return std::nullopt;
    return Refusal{"it makes two poles, none of them at 0"};
  }
  std::unique_ptr<StageForm> make(const Section& section, const FormOptions&) const override {
    return std::make_unique<Khn>(section);
  }
};

}  // namespace

BODESMITH_ENTRY(Realisation, khn, KhnRealisation)

}  // namespace bodesmith::synthesis
