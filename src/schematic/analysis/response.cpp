#include "schematic/analysis/response.hpp"

#include "base/progress.hpp"

namespace bodesmith::schematic {

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
