#include "gap/effects/mode_starts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <vector>

namespace bodesmith::gap {
namespace {

using Complex = std::complex<double>;

constexpr std::array kTriedDampings = {0.003, 0.01, 0.03, 0.1, 0.3};

struct TriedMode {
  double hz = 0.0;
  double damping = 0.0;
  double gain = 0.0;
  double left = 0.0;
};

/// Points of T, of 1 + S, of R, and the frequencies.
struct ModePoints {
  std::vector<double> hz;
  std::vector<double> weight;
  std::vector<Complex> wanted;
  std::vector<Complex> present;
  std::vector<Complex> parallel;
};

ModePoints mode_points_of(const Scene& scene, const chain::Block& modes) {
  ModePoints p;
  const double resonator_hz = modes.get("resonator_hz");
  const double resonator_damping = modes.get("resonator_damping_ratio");
  for (std::size_t i = 0; i < scene.frequency.size(); ++i) {
    const auto here = modes.response(scene.frequency[i].rad_s());
    const Complex present = here ? *here : Complex(1.0);
    const Complex wanted = scene.measured_over_model[i] * present;
    const double weight = scene.weights.empty() ? 1.0 : scene.weights[i];
    p.hz.push_back(scene.frequency[i].value);
    p.weight.push_back(weight / std::max(std::abs(wanted), 1e-300));
    p.wanted.push_back(wanted);
    p.present.push_back(present);
    const double r = resonator_hz > 0.0 ? scene.frequency[i].value / resonator_hz : 0.0;
    p.parallel.emplace_back(1.0 - r * r, 2.0 * resonator_damping * r);
  }
  return p;
}

double real_product(Complex a, Complex b) {
  return a.real() * b.real() + a.imag() * b.imag();
}

/// Least squares for c and g of one frequency and damping; left < 0 where c is none.
TriedMode solve_mode(const ModePoints& p, double hz, double damping) {
  double aa = 0.0;
  double ab = 0.0;
  double bb = 0.0;
  double at = 0.0;
  double bt = 0.0;
  double tt = 0.0;
  for (std::size_t i = 0; i < p.hz.size(); ++i) {
    const double r = p.hz[i] / hz;
    const Complex denominator(1.0 - r * r, 2.0 * damping * r);
    const Complex mode = p.weight[i] / std::norm(denominator) * p.parallel[i] * std::conj(denominator);
    const Complex direct = p.weight[i] * p.present[i];
    const Complex wanted = p.weight[i] * p.wanted[i];
    aa += std::norm(direct);
    ab += real_product(direct, mode);
    bb += std::norm(mode);
    at += real_product(direct, wanted);
    bt += real_product(mode, wanted);
    tt += std::norm(wanted);
  }
  const double determinant = aa * bb - ab * ab;
  if (!(determinant > 1e-9 * aa * bb)) return {hz, damping, 0.0, -1.0};
  const double c = (at * bb - bt * ab) / determinant;
  const double g = (bt * aa - at * ab) / determinant;
  if (!(c > 0.0)) return {hz, damping, 0.0, -1.0};
  return {hz, damping, g / c, tt - c * at - g * bt};
}

}  // namespace

Starts mode_starts(const Scene& scene, const chain::Block& modes) {
  const ModePoints points = mode_points_of(scene, modes);
  std::vector<TriedMode> tried;
  for (const double hz : points.hz) {
    for (double damping : kTriedDampings) {
      const TriedMode one = solve_mode(points, hz, damping);
      if (one.left >= 0.0 && one.gain != 0.0) tried.push_back(one);
    }
  }
  std::stable_sort(tried.begin(), tried.end(),
                   [](const TriedMode& a, const TriedMode& b) { return a.left < b.left; });
  // Of two peaks of one sign nearer than their widths the better one.
  const auto near = [](const TriedMode& a, const TriedMode& b) {
    return (a.gain > 0.0) == (b.gain > 0.0) &&
           std::abs(std::log(a.hz / b.hz)) < std::max(a.damping, b.damping);
  };
  Starts starts;
  for (const TriedMode& t : best_apart(tried, near)) starts.push_back({t.hz, t.damping, t.gain});
  return starts;
}

}  // namespace bodesmith::gap
