#include "tracking/waveforms.hpp"

#include <algorithm>
#include <cmath>

namespace bodesmith::tracking {

BranchCurve::BranchCurve(const Disturbance& disturbance, double alpha) : alpha_(alpha) {
  for (const Disturbance::Branch branch : kBranches) {
    double scale = disturbance.amplitude.at(branch, alpha);
    for (std::size_t i = 0; i < 3; ++i) {
      scale /= alpha;
      a_[branch_index(branch)][i] = scale * disturbance.coefficients(branch)[i];
    }
  }
}

BranchCurve::BranchCurve(const Disturbance& disturbance, double alpha, Hertz operating)
    : BranchCurve(disturbance, alpha) {
  for (const Disturbance::Branch branch : kBranches) {
    const double gain = disturbance.rate_gain(branch, operating);
    for (double& a : a_[branch_index(branch)]) a *= gain;
  }
}

double BranchCurve::steepest(std::size_t branch) const {
  // d' is a parabola: its ends and, where that lies inside, its vertex.
  const std::array<double, 3>& a = a_[branch];
  double most = std::max(std::abs(slope(branch, 0.0)), std::abs(slope(branch, alpha_)));
  const double vertex = a[2] == 0.0 ? -1.0 : -a[1] / (3.0 * a[2]);
  if (vertex > 0.0 && vertex < alpha_) most = std::max(most, std::abs(slope(branch, vertex)));
  return most;
}

}  // namespace bodesmith::tracking
