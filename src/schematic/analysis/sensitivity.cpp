#include "schematic/analysis/sensitivity.hpp"

#include <cmath>

namespace bodesmith::schematic {

std::vector<std::complex<double>> log_sensitivities(const Equations& equations, std::size_t parts,
                                                    RadPerSecond w) {
  using Complex = std::complex<double>;
  const Eigen::VectorXcd x = solve_sparse(equations.small_signal(w)), y = equations.ways_to(w);
  const Complex h = x(equations.node("out"));
  std::vector<Complex> out(parts, 0.0);
  if (!(std::abs(h) > 0.0)) return out;
  std::vector<Stamps::Slope> slopes;
  for (std::size_t i = 0; i < parts; ++i) {
    const auto power = equations.part(i).power_of_value();
    if (!power) continue;
    slopes.clear();
    Stamps stamps({}, {}, slopes);
    equations.part(i).stamp({}, stamps);
    Complex change = 0.0;
    for (const Stamps::Slope& one : slopes)
      change -= y(one.row) * Complex(one.f, w.value * one.q) * (one.column == kInput ? 1.0 : x(one.column));
    change *= *power / h;
    if (std::isfinite(change.real()) && std::isfinite(change.imag())) out[i] = change;
  }
  return out;
}

}  // namespace bodesmith::schematic
