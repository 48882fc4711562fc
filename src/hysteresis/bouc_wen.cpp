#include "hysteresis/bouc_wen.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.hpp"

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
  out.delta = values.number("delta");
  if (!(std::abs(out.gamma) <= out.beta))
    throw DesignError("gamma is outside [-beta, beta]: the state would grow without bound");
  if (!(std::abs(out.delta) <= out.beta - std::abs(out.gamma)))
    throw DesignError(
        "delta is outside [|gamma| - beta, beta - |gamma|]: the state would grow without bound");
  return out;
}

namespace {

/// Part of the drive up to which c |z|^n is near 0: a dozen terms of the series about z = 0 are exact there.
constexpr double kNearZero = 0.1;
/// The part at which a move away from 0 leaves that series: a little beyond, so that it does not come back to it.
constexpr double kLeavesZero = 0.11;
/// Of z, what the last two terms of a Taylor step may be.
constexpr double kStepTolerance = 1e-11;

/// ∫ dζ/(1 − x (ζ/z)^n) from 0 to z, over z: Σ x^k/(k n + 1).
double mean_slowness(double x, double n) {
  double sum = 1.0, power = x;
  for (int k = 1; std::abs(power) > 1e-15; ++k, power *= x) sum += power / (k * n + 1.0);
  return sum;
}

/// |z| at the end of the move, or at 0, or where it leaves what is near 0; `left` becomes what remains. d|z|/ds =
/// ±drive (1 ∓ c |z|^n) is separable: s drive = |z| mean_slowness(±c |z|^n), solved for |z| by Newton. `size`: |z| now, `power`: its
/// power n, c over the drive's size, `away` from 0.
double moved_near_zero(double n, double c, bool away, double size, double power, double drive, double& left) {
  const double way = away ? c : -c;
  const double from = size * mean_slowness(way * power, n);
  const double to = away ? from + drive * left : from - drive * left;
  if (to <= 0.0) {
    left -= from / drive;
    return 0.0;
  }
  double z = to;
  if (away && c * std::pow(z, n) > kLeavesZero) {
    z = std::pow(kLeavesZero / c, 1.0 / n);
    const double end = z * mean_slowness(kLeavesZero, n);
    if (to >= end) {
      left -= (end - from) / drive;
      return z;
    }
  }
  left = 0.0;
  for (int i = 0; i < 6; ++i) {
    const double x = way * std::pow(z, n);
    const double off = z * mean_slowness(x, n) - to;
    z -= off * (1.0 - x);
    if (std::abs(off) <= 1e-15 * to) break;
  }
  return z;
}

/// A step of dz/ds = drive − c |z|^n by its Taylor series, over all that is left or as far as the series reaches: with w = |z|^n,
/// z w' = n w z'. `rate`: dz/ds now.
double taylor_step(double n, double c, double z, double w_now, double rate, double& left) {
  constexpr int kOrder = 12;
  // Four times what z or its slope need to change by their own size is beyond every such series' reach.
  const double reach = 4.0 * std::abs(z) / std::max(std::abs(rate), n * std::abs(c) * w_now);
  const double h = std::min(left, reach);
  const double small = kStepTolerance * std::abs(z);
  static constexpr auto kPart = [] {
    std::array<double, kOrder + 1> parts{};
    for (std::size_t k = 1; k <= kOrder; ++k) parts[k] = 1.0 / static_cast<double>(k);
    return parts;
  }();
  const double by = 1.0 / z, slope = -c * h;
  double at[kOrder + 1], w[kOrder];  // coefficients of (s/h)^k
  at[0] = z;
  at[1] = rate * h;
  w[0] = w_now;
  int order = 1;
  while (order < kOrder && !(order > 2 && std::abs(at[order]) <= small && std::abs(at[order - 1]) <= small)) {
    double sum = 0.0;
    for (int j = 1; j <= order; ++j) sum += (n * j - (order - j)) * at[j] * w[order - j];
    w[order] = sum * by * kPart[static_cast<std::size_t>(order)];
    at[order + 1] = w[order] * slope * kPart[static_cast<std::size_t>(order) + 1];
    ++order;
  }
  double part = 1.0;
  for (double last = std::abs(at[order]), before = std::abs(at[order - 1]); last > small || before > small;
       part *= 0.5) {
    last = std::ldexp(last, -order);
    before = std::ldexp(before, 1 - order);
  }
  left = part * h < left ? left - part * h : 0.0;
  double sum = at[order];
  for (int k = order; k-- > 0;) sum = sum * part + at[k];
  return sum;
}

}  // namespace

double BoucWen::advance(double z, double du) const {
  if (du == 0.0) return z;
  const double direction = du > 0.0 ? 1.0 : -1.0;
  double left = std::abs(du);
  if (n == 1.0) {
    // dz/ds = direction·A − c z in s = |u − u₀|, where c depends on the sign of z: at most one crossing of 0.
    for (int piece = 0; piece < 2 && left > 0.0; ++piece) {
      // Sign of z along the piece: z's own, or where it is 0 the way it is driven.
      const double sign = z != 0.0 ? (z > 0.0 ? 1.0 : -1.0) : (A * direction >= 0.0 ? 1.0 : -1.0);
      const double c = beta + direction * (delta + gamma * sign);  // ≥ 0
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
  const double drive = direction * A;
  while (left > 0.0) {
    const double sign = (z != 0.0 ? z > 0.0 : drive >= 0.0) ? 1.0 : -1.0;
    // ≥ 0: dz/ds = drive − sign c |z|^n on this side of 0.
    const double c = beta + direction * (delta + gamma * sign);
    const double power = std::pow(std::abs(z), n);
    // A move far shorter than the way to 0 is quicker by Taylor's series.
    if (c * power <= kNearZero * std::abs(drive) && std::abs(drive) * left > 0.03 * std::abs(z)) {
      z = sign * moved_near_zero(n, c / std::abs(drive), drive * sign >= 0.0, std::abs(z), power,
                                 std::abs(drive), left);
      continue;
    }
    const double rate = drive - sign * c * power;
    // Where z has settled it stays: its slope only falls on the way there. Without this a steep loop (a large beta
    // that a search tries) costs steps in proportion to beta at every sample.
    if (std::abs(rate) * left <= 1e-12 * std::abs(z) || std::abs(rate) <= kStepTolerance * n * c * power)
      break;
    z = taylor_step(n, sign * c, z, power, rate, left);
  }
  return z;
}

namespace {

class BoucWenType final : public ShapedModelType<BoucWen, BoucWenOperator> {
 public:
  BoucWenType()
      : ShapedModelType("bouc_wen", "differential equation with a hysteretic state",
                        {
                            any_number("k", "y/u", "slope without hysteresis"),
                            any_number("A", "y/u", "slope with which the hysteretic part starts"),
                            above_zero("beta", "u^-1 y^(1-n)", "width of the loop"),
                            any_number("gamma", "u^-1 y^(1-n)", "shape of the loop, within ±beta"),
                            between("n", "1", "sharpness of the corner", 1.0, 50.0).with_default(1.0),
                            any_number("z_0", "y", "hysteretic part that a reset assumes").with_default(0.0),
                            any_number("offset", "y", "constant added at the output").with_default(0.0),
                            any_number("delta", "u^-1 y^(1-n)",
                                       "rate of a rising input above beta, of a falling one below")
                                .with_default(0.0),
                        }) {}

  /// A sharpness of 1 has a closed form.
  bool steps_within_samples(const Parameters& values) const override { return values.number("n") != 1.0; }

 protected:
  /// Rises where k exceeds the steepest dz/du, which over the bounded states is max(A, −A + …): at a reversal
  /// from saturation |z| = (A/(beta+gamma))^(1/n) it is A (1 + (beta − gamma)/(beta + gamma)).
  std::unique_ptr<Inverse> inverse_of(const BoucWen& model) const override {
    const double skew = std::abs(model.delta);
    const double steepest =
        model.A >= 0.0
            ? model.A * (1.0 + std::max(0.0, (model.beta + skew - model.gamma) /
                                                 std::max(model.beta - skew + model.gamma, 1e-300)))
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
