#include <algorithm>
#include <cmath>

#include "synthesis/realisation.hpp"

namespace bodesmith::synthesis {
namespace {

/// Multiple feedback (Rauch), low-pass:
///   H = -(R2/R1)/(1 + s C1 (R2 + R3 + R2 R3/R1) + s^2 R2 R3 C1 C2).
class FeedbackLowPass final : public StageForm {
 public:
  explicit FeedbackLowPass(const Section& section) {
    wanted_ = Biquad::from_section(negated(section));
    gain_ = std::abs(wanted_.b0 / wanted_.a0);
    b1_ = wanted_.a1 / wanted_.a0;
    b2_ = 1.0 / wanted_.a0;
    const double w0 = std::sqrt(wanted_.a0);
    resistor("R1", "in", "a");
    resistor("R2", "a", "out");
    resistor("R3", "a", "m");
    // Real resistors need C1/C2 <= 1/(4 Q^2 (1 + gain)).
    const double ratio = std::min(1.0, 0.75 * b1_ * b1_ / (4.0 * b2_ * (1.0 + gain_)));
    capacitor("C2", "a", "0", {w0 * std::min(1.0, gain_)});
    capacitor("C1", "m", "out", {w0}, ratio);
    opamp("U1", "0", "m", "out");
  }

  Biquad transfer(std::span<const double> v) const override {
    const double r1 = v[0], r2 = v[1], r3 = v[2], c2 = v[3], c1 = v[4];
    return {.b0 = -r2 / r1, .a0 = 1.0, .a1 = c1 * (r2 + r3 + r2 * r3 / r1), .a2 = r2 * r3 * c1 * c2};
  }

  std::optional<std::vector<double>> design(std::span<const double> c) const override {
    const double discriminant = b1_ * b1_ - 4.0 * c[1] * (1.0 + gain_) * b2_ / c[0];
    if (discriminant < 0.0) return std::nullopt;
    const double r2 = (b1_ + std::sqrt(discriminant)) / (2.0 * c[1]);
    return std::vector<double>{r2 / gain_, r2, b2_ / (r2 * c[0] * c[1]), c[0], c[1]};
  }

 private:
  double gain_ = 1.0, b1_ = 0.0, b2_ = 0.0;
};

/// Band-pass (Deliyannis): H = -(s/(R1 C1))/(s^2 + s (1/C1 + 1/C2)/R3 + (1/R1 + 1/R2)/(R3 C1 C2)).
class FeedbackBandPass final : public StageForm {
 public:
  explicit FeedbackBandPass(const Section& section) {
    wanted_ = Biquad::from_section(negated(section));
    const double w0 = std::sqrt(wanted_.a0);
    resistor("R1", "in", "a");
    resistor("R2", "a", "0");
    resistor("R3", "m", "out");
    capacitor("C1", "a", "out", {w0});
    capacitor("C2", "a", "m", {w0});
    opamp("U1", "0", "m", "out");
  }

  Biquad transfer(std::span<const double> v) const override {
    const double r1 = v[0], r2 = v[1], r3 = v[2], c1 = v[3], c2 = v[4];
    return {.b1 = -1.0 / (r1 * c1),
            .a0 = (1.0 / r1 + 1.0 / r2) / (r3 * c1 * c2),
            .a1 = (1.0 / c1 + 1.0 / c2) / r3,
            .a2 = 1.0};
  }

  std::optional<std::vector<double>> design(std::span<const double> c) const override {
    const double r3 = (1.0 / c[0] + 1.0 / c[1]) / wanted_.a1;
    const double g1 = std::abs(wanted_.b1) * c[0];
    const double g2 = wanted_.a0 * r3 * c[0] * c[1] - g1;
    if (!(g2 > 0.0)) return std::nullopt;
    return std::vector<double>{1.0 / g1, 1.0 / g2, r3, c[0], c[1]};
  }
};

/// High-pass: H = -(C1/C3) s^2/(s^2 + s (C1 + C2 + C3)/(R2 C2 C3) + 1/(R1 R2 C2 C3)).
class FeedbackHighPass final : public StageForm {
 public:
  explicit FeedbackHighPass(const Section& section) : gain_(section.gain) {
    wanted_ = Biquad::from_section(negated(section));
    const double w0 = std::sqrt(wanted_.a0);
    resistor("R1", "a", "0");
    resistor("R2", "m", "out");
    capacitor("C1", "in", "a", {w0});
    capacitor("C2", "a", "m", {w0}, 1.0);
    capacitor("C3", "a", "out", {w0}, 1.0 / gain_);
    opamp("U1", "0", "m", "out");
  }

  Biquad transfer(std::span<const double> v) const override {
    const double r1 = v[0], r2 = v[1], c1 = v[2], c2 = v[3], c3 = v[4];
    return {
        .b2 = -c1 / c3, .a0 = 1.0 / (r1 * r2 * c2 * c3), .a1 = (c1 + c2 + c3) / (r2 * c2 * c3), .a2 = 1.0};
  }

  std::optional<std::vector<double>> design(std::span<const double> c) const override {
    const double r2 = (c[0] + c[1] + c[2]) / (wanted_.a1 * c[1] * c[2]);
    return std::vector<double>{1.0 / (wanted_.a0 * r2 * c[1] * c[2]), r2, c[0], c[1], c[2]};
  }

  std::optional<std::vector<double>> exact_near(std::span<const double> v) const override {
    const double c[3] = {v[2], v[3], v[2] / gain_};
    return design(c);
  }

 private:
  double gain_;
};

bool at_origin(const Section& section) {
  return std::ranges::all_of(section.zeros, [](auto z) { return std::abs(z) == 0.0; });
}

class MultipleFeedbackRealisation final : public StageRealisation {
 public:
  std::string_view name() const override { return "multiple-feedback"; }
  std::optional<Refusal> refusal(const Section& section) const override {
    if (section.poles.size() != 2) return Refusal{"it makes two poles"};
    if (!at_origin(section)) return Refusal{"it makes a low-pass, band-pass or high-pass, no other zeros"};
    if (section.zeros.size() == 1) {
      // The gain at the middle cannot exceed 2 Q^2.
      const Biquad h = Biquad::from_section(section);
      if (h.b1 * h.a1 >= 2.0 * h.a0 * 0.999)
        return Refusal{"as a band-pass its gain at the middle must stay below 2 Q^2"};
    }
    return std::nullopt;
  }
  std::unique_ptr<StageForm> make(const Section& section, const FormOptions&) const override {
    if (section.zeros.empty()) return std::make_unique<FeedbackLowPass>(section);
    if (section.zeros.size() == 1) return std::make_unique<FeedbackBandPass>(section);
    return std::make_unique<FeedbackHighPass>(section);
  }
};

}  // namespace

BODESMITH_ENTRY(Realisation, multiple_feedback, MultipleFeedbackRealisation)

}  // namespace bodesmith::synthesis
