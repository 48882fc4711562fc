#include "fpaa/polynomial_error.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "fpaa/cams/multiplier.hpp"
#include "fpaa/cams/sum_diff.hpp"

namespace bodesmith::fpaa {
namespace {

/// Of the stroke, at which the polynomials are compared.
constexpr int kStrokePoints = 4001;
/// Of the multipliers and the table, on the board.
constexpr double kFullScaleV = 3.0;

double stroke_point(int i) {
  return i / (kStrokePoints - 1.0);
}

double max_magnitude(const Disturbance& d, Disturbance::Branch branch) {
  double out = 0.0;
  for (int i = 0; i < kStrokePoints; ++i) out = std::max(out, std::abs(d.value(branch, stroke_point(i))));
  return out;
}

/// One branch made in one way.
class MadeBranch {
 public:
  MadeBranch(const Disturbance& d, Disturbance::Branch branch, PolynomialBy by, double outside_error_percent)
      : d_(d),
        branch_(branch),
        by_(by),
        a_(d.coefficients(branch)),
        outside_error_(outside_error_percent / 100.0) {
    const SumDiff sum = SumDiff::best({a_[0], a_[1], a_[2]});
    for (std::size_t i = 0; i < weights_.size(); ++i) {
      weights_[i] = a_[i] == 0.0 ? 0.0 : sum.transfer(i).dc_gain();
    }
    if (by == PolynomialBy::lookup) table_ = value_or_throw(branch_table(d, branch));
  }

  /// |made - d| at x.
  double error(double x) const {
    const double wanted = d_.value(branch_, x);
    switch (by_) {
      case PolynomialBy::lookup:
        return std::abs(
            table_.table.output(2.0 * kFullScaleV * x - kFullScaleV) * table_.scale / kFullScaleV - wanted);
      case PolynomialBy::multipliers: {
        const Multiplier multiplier{1.0 / kFullScaleV, false};
        const double v = kFullScaleV * x;
        const double square = multiplier.output(v, v);
        const double cube = multiplier.output(square, v);
        const double made = weights_[0] * v + weights_[1] * square + weights_[2] * cube;
        return std::abs(made / kFullScaleV - wanted);
      }
      case PolynomialBy::outside:
        break;
    }
    // Each multiplier is off by the same share of its full scale, with the worst signs; the second squares
    // the first one's error with its own.
    const double e = outside_error_;
    const double made = weights_[0] * x + weights_[1] * x * x + weights_[2] * x * x * x;
    return std::abs(made - wanted) + std::abs(a_[1]) * e + std::abs(a_[2]) * (e * x + e);
  }

 private:
  const Disturbance& d_;
  Disturbance::Branch branch_;
  PolynomialBy by_;
  std::array<double, 3> a_;
  std::array<double, 3> weights_{};
  double outside_error_;
  BranchTable table_;
};

}  // namespace

double branch_volts(const Disturbance& d, Disturbance::Branch branch, double scale, double input_v) {
  const double x = std::clamp((input_v + kFullScaleV) / (2.0 * kFullScaleV), 0.0, 1.0);
  return kFullScaleV * d.value(branch, x) / scale;
}

Outcome<BranchTable> branch_table(const Disturbance& d, Disturbance::Branch branch) {
  const double scale = max_magnitude(d, branch);
  const Outcome<LookupTable> table =
      LookupTable::of([&](double v) { return branch_volts(d, branch, scale, v); });
  if (const Refusal* refusal = refusal_of(table)) return *refusal;
  return BranchTable{std::get<LookupTable>(table), scale};
}

PolynomialError polynomial_error(const Disturbance& d, PolynomialBy by, double outside_error_percent) {
  PolynomialError out;
  double sum = 0.0;
  for (const auto branch : {Disturbance::Branch::ascending, Disturbance::Branch::descending}) {
    if (max_magnitude(d, branch) == 0.0) continue;
    const MadeBranch made(d, branch, by, outside_error_percent);
    for (int i = 0; i < kStrokePoints; ++i) {
      const double error = made.error(stroke_point(i));
      out.max_percent = std::max(out.max_percent, 100.0 * error);
      sum += 1e4 * error * error;
    }
  }
  out.rms_percent = std::sqrt(sum / (2.0 * kStrokePoints));
  return out;
}

}  // namespace bodesmith::fpaa
