#include "fpaa/controller/scale.hpp"

#include <algorithm>
#include <cmath>

namespace bodesmith::fpaa {
namespace {

using Direction = Disturbance::Branch;

/// Of the stroke, at which the range is looked for.
constexpr int kRangePoints = 401;
/// Of full scale left free at either end: overshoot, steps of the converters.
constexpr double kFreeShare = 0.02;
/// Volts per stroke are a whole number of these steps, so that a person can set them.
constexpr double kScaleStepsPerV = 20.0;

}  // namespace

double settled_drive(const Disturbance& d, Direction branch, double gain, double r) {
  constexpr int kPasses = 60;
  double v = r;
  for (int pass = 0; pass < kPasses; ++pass) {
    const double next = std::clamp(r - gain * d.value(branch, v), -1.0, 2.0);
    if (std::abs(next - v) < 1e-9) return next;
    v = next;
  }
  return std::clamp(r - gain * d.value(branch, r), -1.0, 2.0);
}

std::vector<double> rate_gains(const Disturbance& d, Direction branch, const BranchPlans& compensators) {
  if (compensators[branch_index(branch)] != nullptr || d.rate.frequency.empty()) return {1.0};
  return d.rate.of(branch);
}

DriveRange drive_range(const Disturbance& d, const BranchPlans& compensators) {
  DriveRange out;
  for (const Direction branch : kBranches) {
    for (const double gain : rate_gains(d, branch, compensators)) {
      for (int i = 0; i < kRangePoints; ++i) {
        const double v = settled_drive(d, branch, gain, i / (kRangePoints - 1.0));
        out.low = std::min(out.low, v);
        out.high = std::max(out.high, v);
      }
    }
  }
  for (const Direction branch : kBranches) {
    for (const double gain : rate_gains(d, branch, compensators)) {
      for (int i = 0; i < kRangePoints; ++i) {
        const double x = out.low + (out.high - out.low) * i / (kRangePoints - 1.0);
        const double factor = std::abs(gain * d.slope(branch, x));
        if (factor > out.contraction.factor) out.contraction = {factor, x, gain, branch};
      }
    }
  }
  return out;
}

VoltScale volt_scale(const DriveRange& range, bool bipolar) {
  const double usable = kFullScaleV * (1.0 - kFreeShare);
  const double wanted =
      bipolar ? 2.0 * usable / (range.high - range.low) : usable / std::max(-range.low, range.high);
  const double steps = std::floor(wanted * kScaleStepsPerV);
  return {steps >= 1.0 ? steps / kScaleStepsPerV : wanted, bipolar ? 0.5 * (range.low + range.high) : 0.0};
}

double greatest_disturbance(const Disturbance& d, Direction branch, const DriveRange& range) {
  double out = 0.0;
  for (int i = 0; i < kRangePoints; ++i) {
    const double x = range.low + (range.high - range.low) * i / (kRangePoints - 1.0);
    out = std::max(out, std::abs(d.value(branch, x)));
  }
  return out;
}

}  // namespace bodesmith::fpaa
