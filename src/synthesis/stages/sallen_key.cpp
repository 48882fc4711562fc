#include <algorithm>
#include <cmath>

#include "synthesis/realisation.hpp"

namespace bodesmith::synthesis {
namespace {

/// Sallen and Key (IRE Trans. Circuit Theory CT-2, 1955), low-pass with gain K = 1 + Rb/Ra:
///   H = K d/(1 + s [C2 (R1 + R2) + (1 - K) R1 C1] + s^2 R1 R2 C1 C2).
/// A gain below 1 is made by splitting R1 into a divider: R1 = Ri || Rj, d = Rj/(Ri + Rj), K = 1.
class SallenKeyLowPass final : public StageForm {
 public:
  explicit SallenKeyLowPass(const Section& section) {
    wanted_ = Biquad::from_section(section);
    gain_ = wanted_.b0 / wanted_.a0;
    b1_ = wanted_.a1 / wanted_.a0;
    b2_ = 1.0 / wanted_.a0;
    k_ = std::max(1.0, gain_);
    divided_ = gain_ < 1.0 - 1e-12;
    amplified_ = gain_ > 1.0 + 1e-12;
    resistor(divided_ ? "Ri" : "R1", "in", "a");
    if (divided_) resistor("Rj", "a", "0");
    resistor("R2", "a", "p");
    if (amplified_) {
      resistor("Ra", "m", "0");
      resistor("Rb", "m", "out");
    }
    const double w0 = std::sqrt(wanted_.a0);
    // Real resistors need C2/C1 <= 1/(4 Q^2) + K - 1.
    const double ratio = std::min(1.0, 0.75 * (b1_ * b1_ / (4.0 * b2_) + k_ - 1.0));
    capacitor("C1", "a", "out", {w0 * (divided_ ? gain_ : 1.0)});
    capacitor("C2", "p", "0", {w0}, ratio);
    opamp("U1", "p", amplified_ ? "m" : "out", "out");
  }

  Biquad transfer(std::span<const double> v) const override {
    std::size_t i = 1;
    double r1 = v[0], d = 1.0, k = 1.0;
    if (divided_) {
      d = v[1] / (v[0] + v[1]);
      r1 = v[0] * d;
      i = 2;
    }
    const double r2 = v[i++];
    if (amplified_) {
      k = 1.0 + v[i + 1] / v[i];
      i += 2;
    }
    const double c1 = v[i], c2 = v[i + 1];
    return {.b0 = k * d, .a0 = 1.0, .a1 = c2 * (r1 + r2) + (1.0 - k) * r1 * c1, .a2 = r1 * r2 * c1 * c2};
  }

  std::optional<std::vector<double>> design(std::span<const double> c) const override {
    const double a = c[1] + (1.0 - k_) * c[0];
    const double discriminant = b1_ * b1_ - 4.0 * a * b2_ / c[0];
    if (discriminant < 0.0) return std::nullopt;
    const double r1 = 2.0 * b2_ / c[0] / (b1_ + std::sqrt(discriminant));
    std::vector<double> values;
    if (divided_) {
      values.push_back(r1 / gain_);
      values.push_back(r1 / (1.0 - gain_));
    } else {
      values.push_back(r1);
    }
    values.push_back(b2_ / (r1 * c[0] * c[1]));
    if (amplified_) {
      const double ra = std::max(10e3 / std::max(1.0, k_ - 1.0), 2e3);
      values.push_back(ra);
      values.push_back(ra * (k_ - 1.0));
    }
    values.push_back(c[0]);
    values.push_back(c[1]);
    return values;
  }

 private:
  double gain_ = 1.0, b1_ = 0.0, b2_ = 0.0, k_ = 1.0;
  bool divided_ = false, amplified_ = false;
};

/// The high-pass: R and C changed places; K = 1 + Rb/Ra,
///   H = K d s^2 R1 R2 C1 C2/(1 + s [R1 (C1 + C2) + (1 - K) R2 C2] + s^2 R1 R2 C1 C2),
/// d = Ci/(Ci + Cj) where a gain below 1 splits C1 = Ci + Cj.
class SallenKeyHighPass final : public StageForm {
 public:
  explicit SallenKeyHighPass(const Section& section) {
    wanted_ = Biquad::from_section(section);
    gain_ = section.gain;
    b1_ = wanted_.a1 / wanted_.a0;
    b2_ = 1.0 / wanted_.a0;
    k_ = std::max(1.0, gain_);
    divided_ = gain_ < 1.0 - 1e-12;
    amplified_ = gain_ > 1.0 + 1e-12;
    const double w0 = std::sqrt(wanted_.a0);
    capacitor(divided_ ? "Ci" : "C1", "in", "a", {w0});
    if (divided_) capacitor("Cj", "a", "0", {w0}, (1.0 - gain_) / gain_, 1.3);
    capacitor("C2", "a", "p", {w0}, divided_ ? 1.0 / gain_ : 1.0);
    resistor("R1", "a", "out");
    resistor("R2", "p", "0");
    if (amplified_) {
      resistor("Ra", "m", "0");
      resistor("Rb", "m", "out");
    }
    opamp("U1", "p", amplified_ ? "m" : "out", "out");
  }

  Biquad transfer(std::span<const double> v) const override {
    const std::size_t i = divided_ ? 2 : 1;
    const double c1 = divided_ ? v[0] + v[1] : v[0], d = divided_ ? v[0] / c1 : 1.0;
    const double c2 = v[i], r1 = v[i + 1], r2 = v[i + 2];
    const double k = amplified_ ? 1.0 + v[i + 4] / v[i + 3] : 1.0;
    return {.b2 = k * d * r1 * r2 * c1 * c2,
            .a0 = 1.0,
            .a1 = r1 * (c1 + c2) + (1.0 - k) * r2 * c2,
            .a2 = r1 * r2 * c1 * c2};
  }

  std::optional<std::vector<double>> design(std::span<const double> c) const override {
    const double c1 = divided_ ? c[0] + c[1] : c[0], c2 = c.back();
    const double sum = c1 + c2;
    const double r1 = (b1_ + std::sqrt(b1_ * b1_ + 4.0 * (k_ - 1.0) * sum * b2_ / c1)) / (2.0 * sum);
    std::vector<double> values(c.begin(), c.end());
    values.push_back(r1);
    values.push_back(b2_ / (r1 * c1 * c2));
    if (amplified_) {
      const double ra = std::max(10e3 / std::max(1.0, k_ - 1.0), 2e3);
      values.push_back(ra);
      values.push_back(ra * (k_ - 1.0));
    }
    return values;
  }

  std::optional<std::vector<double>> exact_near(std::span<const double> realised) const override {
    std::vector<double> c = capacitors(realised);
    if (divided_) {
      const double sum = c[0] + c[1];
      c[0] = sum * gain_;
      c[1] = sum * (1.0 - gain_);
    }
    return design(c);
  }

 private:
  double gain_ = 1.0, b1_ = 0.0, b2_ = 0.0, k_ = 1.0;
  bool divided_ = false, amplified_ = false;
};

class SallenKeyRealisation final : public StageRealisation {
 public:
  std::string_view name() const override { return "sallen-key"; }
  bool inverts() const override { return false; }
  /// Zeros at the origin: Tow-Thomas makes them as differences of resistors, which no preferred value meets.
  int bid(const Section& section) const override {
    return is_high_pass(section) && quality_of(section) <= kSallenKeyMaxQuality ? 2 : 0;
  }
  std::optional<Refusal> refusal(const Section& section) const override {
    if (section.poles.size() != 2) return Refusal{"it makes two poles"};
    if (!section.zeros.empty() && !is_high_pass(section))
      return Refusal{"it makes a low-pass or a high-pass, no other zeros"};
    return std::nullopt;
  }
  std::unique_ptr<StageForm> make(const Section& section, const FormOptions&) const override {
    if (section.zeros.empty()) return std::make_unique<SallenKeyLowPass>(section);
    return std::make_unique<SallenKeyHighPass>(section);
  }
};

}  // namespace

BODESMITH_ENTRY(Realisation, sallen_key, SallenKeyRealisation)

}  // namespace bodesmith::synthesis
