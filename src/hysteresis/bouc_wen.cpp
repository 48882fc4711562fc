#include "hysteresis/bouc_wen.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "hysteresis/identification.hpp"

namespace bodesmith::hysteresis {

BoucWen BoucWen::from(const Parameters& values) {
  BoucWen out;
  out.k = values.number("k");
  out.A = values.number("A");
  out.beta = values.number("beta");
  out.gamma = values.number("gamma");
  out.n = values.number("n");
  out.z_0 = values.number("z_0");
  out.offset = values.number("offset");
  if (!(std::abs(out.gamma) <= out.beta))
    throw DesignError("gamma is outside [-beta, beta]: the state would grow without bound");
  return out;
}

double BoucWen::advance(double z, double du) const {
  if (du == 0.0) return z;
  const double direction = du > 0.0 ? 1.0 : -1.0;
  double left = std::abs(du);
  if (n == 1.0) {
    // dz/ds = direction·A − c z in s = |u − u₀|, where c depends on the sign of z: at most one crossing of 0.
    for (int piece = 0; piece < 2 && left > 0.0; ++piece) {
      // Sign of z along the piece: z's own, or where it is 0 the way it is driven.
      const double sign = z != 0.0 ? (z > 0.0 ? 1.0 : -1.0) : (A * direction >= 0.0 ? 1.0 : -1.0);
      const double c = beta + gamma * direction * sign;  // ≥ 0
      const double drive = A * direction;
      const auto at = [&](double s) {
        return c > 0.0 ? drive / c + (z - drive / c) * std::exp(-c * s) : z + drive * s;
      };
      if (z != 0.0 && drive * z < 0.0) {
        // Falls to 0 within: z = drive/c (1 − e^{cs}).
        const double crossing = c > 0.0 ? std::log1p(-c * z / drive) / c : -z / drive;
        if (crossing < left) {
          left -= crossing;
          z = 0.0;
          continue;
        }
      }
      return at(left);
    }
    return z;
  }
  const auto slope = [&](double value) {
    const double size = std::abs(value);
    const double power = std::pow(size, n);
    return direction * A - beta * (value >= 0.0 ? power : -power) - gamma * direction * power;
  };
  // Steps of a twentieth of the decay where z is: beta + gamma and beta - gamma, of the two signs of z, may differ by any
  // factor. On the way to 0 a quarter of it at most, until a step across 0 is one that the other side bears.
  const double fastest = beta + std::abs(gamma);
  const auto decay_step = [&](double c, double size) { return 0.05 / (c * n * std::pow(size, n - 1.0)); };
  const auto rest_at = [&](double c) { return std::pow(std::abs(A) / c, 1.0 / n); };
  const auto step_at = [&](double value, double rate) {
    const double size = std::abs(value);
    const bool positive = value != 0.0 ? value > 0.0 : direction * A > 0.0;
    const double own = beta + gamma * direction * (positive ? 1.0 : -1.0);
    if (direction * A * value >= 0.0) {
      const double c = own > 0.0 ? own : fastest;
      return decay_step(c, std::max(size, rest_at(c)));
    }
    const double across = std::max(0.25 * size / std::abs(rate), decay_step(fastest, rest_at(fastest)));
    return own > 0.0 ? std::min(decay_step(own, size), across) : across;
  };
  // Whether a step over all that is left is short enough for certain, told from |z|^n alone: |z|^(n-1) is |z|^n/|z|, and
  // rest^(n-1) no more than |A|/c or 1. Finely sampled inputs need no other power for it.
  const auto short_enough = [&](double value, double power, double rate) {
    constexpr double kSafe = 0.99;
    const double size = std::abs(value);
    const double own = value == 0.0 ? 0.0 : beta + gamma * direction * (value > 0.0 ? 1.0 : -1.0);
    if (!(own > 0.0)) return false;
    if (direction * A * value >= 0.0) {
      const double steepest = std::max({power / size, std::abs(A) / own, 1.0});
      return left <= kSafe * 0.05 / (own * n * steepest);
    }
    return left <= kSafe * std::min(0.05 * size / (own * n * power), 0.25 * size / std::abs(rate));
  };
  // z' = f(z) to the fourth power of h, f's derivatives from |z|^n alone: as exact as the four slopes below, for one power
  // instead of four. Away from 0, where those derivatives are of moderate size.
  constexpr double kFarFromZero = 0.02;
  const auto taylor_step = [&](double value, double power, double f, double h) {
    const double own = -(beta + gamma * direction * (value > 0.0 ? 1.0 : -1.0));
    const double by = 1.0 / value;
    const double f1 = own * n * power * std::abs(by);
    const double f2 = f1 * (n - 1.0) * by, f3 = f2 * (n - 2.0) * by;
    const double second = f * f1, third = f * (f1 * f1 + f * f2);
    const double fourth = f * (f1 * f1 * f1 + f * (4.0 * f1 * f2 + f * f3));
    return value + h * (f + h / 2.0 * (second + h / 3.0 * (third + h / 4.0 * fourth)));
  };
  while (left > 0.0) {
    const double power = std::pow(std::abs(z), n);
    const double k1 = direction * A - beta * (z >= 0.0 ? power : -power) - gamma * direction * power;
    // Where z has settled it stays: its slope only falls on the way there. Without this a steep loop (a large beta
    // that a search tries) costs steps in proportion to beta at every sample.
    if (std::abs(k1) * left <= 1e-12 * std::abs(z) || std::abs(k1) <= 1e-13 * std::abs(A)) break;
    double h = left;
    if (!short_enough(z, power, k1)) {
      const double longest = step_at(z, k1);
      if (longest > 0.0) h = std::min(left, longest);
    } else if (std::abs(k1) * h < kFarFromZero * std::abs(z)) {
      z = taylor_step(z, power, k1, h);
      break;
    }
    const double k2 = slope(z + 0.5 * h * k1);
    const double k3 = slope(z + 0.5 * h * k2);
    const double k4 = slope(z + h * k3);
    z += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    left -= h;
    if (left < 1e-15 * std::abs(du)) break;
  }
  return z;
}

namespace {

class BoucWenType final : public ShapedModelType<BoucWen, BoucWenOperator> {
 public:
  BoucWenType()
      : ShapedModelType("bouc_wen", "differential equation with a hysteretic state",
                        "Bouc 1967, Wen 1976; Low and Guo 1995",
                        {
                            any_number("k", "y/u", "slope without hysteresis"),
                            any_number("A", "y/u", "slope with which the hysteretic part starts"),
                            above_zero("beta", "u^-1 y^(1-n)", "width of the loop"),
                            any_number("gamma", "u^-1 y^(1-n)", "shape of the loop, within ±beta"),
                            between("n", "1", "sharpness of the corner", 1.0, 50.0).with_default(1.0),
                            any_number("z_0", "y", "hysteretic part that a reset assumes").with_default(0.0),
                            any_number("offset", "y", "constant added at the output").with_default(0.0),
                        }) {}

  /// A sharpness of 1 has a closed form.
  bool steps_within_samples(const Parameters& values) const override { return values.number("n") != 1.0; }

 protected:
  /// Rises where k exceeds the steepest dz/du, which over the bounded states is max(A, −A + …): at a reversal
  /// from saturation |z| = (A/(beta+gamma))^(1/n) it is A (1 + (beta − gamma)/(beta + gamma)).
  std::unique_ptr<Inverse> inverse_of(const BoucWen& model) const override {
    const double steepest =
        model.A >= 0.0 ? model.A * (1.0 + std::max(0.0, (model.beta - model.gamma) /
                                                            std::max(model.beta + model.gamma, 1e-300)))
                       : 0.0;
    if (!(model.k > steepest))
      throw DesignError(
          "k is not above the steepest slope of the hysteretic part: the output does not always rise with "
          "the input, there is no inverse");
    return std::make_unique<BracketingInverse>(std::make_unique<BoucWenOperator>(model), -1e12, 1e12);
  }
  Identified fit(std::span<const TimeRecord> records, const IdentifyOptions& options) const override {
    return identify_bouc_wen(records, options);
  }
};

}  // namespace

BODESMITH_ENTRY(ModelType, bouc_wen_type, BoucWenType)

}  // namespace bodesmith::hysteresis
