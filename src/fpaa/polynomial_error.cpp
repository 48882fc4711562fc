#include "fpaa/polynomial_error.hpp"

#include <algorithm>
#include <cmath>

#include "fpaa/cams/multiplier.hpp"
#include "fpaa/cams/sum_diff.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr int kPoints = 4001;

double largest(const Disturbance& d, Disturbance::Branch branch) {
  double most = 0.0;
  for (int i = 0; i < kPoints; ++i) most = std::max(most, std::abs(d.value(branch, i / (kPoints - 1.0))));
  return most;
}

}  // namespace

double branch_volts(const Disturbance& d, Disturbance::Branch branch, double scale, double input_v) {
  return 3.0 * d.value(branch, std::clamp((input_v + 3.0) / 6.0, 0.0, 1.0)) / scale;
}

LookupTable branch_table(const Disturbance& d, Disturbance::Branch branch, double& scale) {
  scale = largest(d, branch);
  return LookupTable::of([&](double v) { return branch_volts(d, branch, scale, v); });
}

PolynomialError polynomial_error(const Disturbance& d, PolynomialBy by, double outside_error_percent) {
  PolynomialError out;
  double sum = 0.0;
  for (const auto branch : {Disturbance::Branch::ascending, Disturbance::Branch::descending}) {
    const auto& a = d.coefficients(branch);
    if (largest(d, branch) == 0.0) continue;
    const SumDiff weights = SumDiff::best({a[0], a[1], a[2]});
    const auto weight = [&](size_t i) { return a[i] == 0.0 ? 0.0 : weights.transfer(i).dc_gain(); };
    double scale = 1.0;
    const LookupTable table = branch_table(d, branch, scale);
    for (int i = 0; i < kPoints; ++i) {
      const double x = i / (kPoints - 1.0);
      const double wanted = d.value(branch, x);
      double error = 0.0;
      if (by == PolynomialBy::lookup) {
        error = std::abs(table.output(6.0 * x - 3.0) * scale / 3.0 - wanted);
      } else if (by == PolynomialBy::multipliers) {
        const Multiplier multiplier{1.0 / 3.0, false};
        const double v = 3.0 * x;
        const double square = multiplier.output(v, v);
        const double cube = multiplier.output(square, v);
        error = std::abs((weight(0) * v + weight(1) * square + weight(2) * cube) / 3.0 - wanted);
      } else {
        // Each multiplier is off by the same share of its full scale, with the worst signs; the second
        // squares the first one's error with its own.
        const double e = outside_error_percent / 100.0;
        error = std::abs(weight(0) * x + weight(1) * x * x + weight(2) * x * x * x - wanted) +
                std::abs(a[1]) * e + std::abs(a[2]) * (e * x + e);
      }
      out.max_percent = std::max(out.max_percent, 100.0 * error);
      sum += 1e4 * error * error;
    }
  }
  out.rms_percent = std::sqrt(sum / (2.0 * kPoints));
  return out;
}

}  // namespace bodesmith::fpaa
