#include "schematic/analysis/response.hpp"

#include <cmath>

#include "base/progress.hpp"

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

std::vector<std::complex<double>> network_response(const Netlist& netlist, const std::vector<Hertz>& grid,
                                                   const Assumptions& assumptions) {
  const Equations equations(netlist, assumptions);
  std::vector<std::complex<double>> out;
  out.reserve(grid.size());
  for (const Hertz f : grid) {
    stop_if_interrupted();
    out.push_back(equations.response(f.rad_s()));
  }
  return out;
}

std::complex<double> return_ratio(const Equations& equations, const Netlist& netlist, std::size_t opamp,
                                  RadPerSecond w) {
  const OpAmp& one = netlist.opamps[opamp];
  const OpAmpModel& model = netlist.model_of(one);
  SparseSystem s = equations.small_signal(w);
  const Eigen::Index row = equations.row_of_opamp(opamp);
  s.clear_row(row);
  s.add(row, equations.node(one.out), 1.0);
  s.add(row, row, model.output_resistance_ohm);
  s.b.setZero();
  s.b(row) = 1.0;
  const Eigen::VectorXcd x = solve_sparse(s);
  const auto at = [&](const std::string& name) {
    const int place = equations.node(name);
    return place < 0 ? std::complex<double>(0.0) : x(place);
  };
  return -model.open_loop(w) * (at(one.plus) - at(one.minus));
}

}  // namespace bodesmith::schematic
