#include "fit/triangle_series.hpp"

#include <array>
#include <numbers>

namespace bodesmith {
namespace {

/// 1/2 integral_0^1 (a1 x + a2 x^2 + a3 x^3) e^(-j pi k x) dx: the rising half's share of U_k.
std::complex<double> half_coefficient(const std::array<double, 3>& a, std::size_t k) {
  if (k == 0) return 0.5 * (a[0] / 2.0 + a[1] / 3.0 + a[2] / 4.0);
  const std::complex<double> j_theta(0.0, std::numbers::pi * static_cast<double>(k));
  const double end = k % 2 == 0 ? 1.0 : -1.0;  // e^(-j pi k)
  std::complex<double> moment = (1.0 - end) / j_theta;
  std::complex<double> sum = 0.0;
  for (std::size_t m = 1; m <= 3; ++m) {
    moment = (static_cast<double>(m) * moment - end) / j_theta;  // by parts
    sum += a[m - 1] * moment;
  }
  return 0.5 * sum;
}

}  // namespace

double TriangleSeries::value(double phase) const {
  using Branch = Disturbance::Branch;
  const bool rising = phase < 0.5;
  const double x = rising ? 2.0 * phase : 2.0 - 2.0 * phase;
  if (path == DrivenPath::ascending) return disturbance.value(Branch::ascending, x);
  if (path == DrivenPath::descending) return disturbance.value(Branch::descending, x);
  return disturbance.value(rising ? Branch::ascending : Branch::descending, x);
}

TriangleSeries triangle_series(const Disturbance& disturbance, DrivenPath path, std::size_t harmonics) {
  TriangleSeries out;
  out.disturbance = disturbance;
  out.path = path;
  const auto& up = path == DrivenPath::descending ? disturbance.descending : disturbance.ascending;
  const auto& down = path == DrivenPath::ascending ? disturbance.ascending : disturbance.descending;
  for (std::size_t k = 0; k <= harmonics; ++k) {
    // The falling half is the rising one reversed in time.
    out.coefficient.push_back(half_coefficient(up, k) + std::conj(half_coefficient(down, k)));
  }
  return out;
}

std::string_view to_string(DrivenPath path) {
  switch (path) {
    case DrivenPath::whole:
      return "whole";
    case DrivenPath::ascending:
      return "ascending";
    case DrivenPath::descending:
      return "descending";
  }
  return "";
}

}  // namespace bodesmith
