#include "circuit/response.hpp"

#include "base/progress.hpp"
#include "circuit/network.hpp"

namespace bodesmith::circuit {
namespace {

std::vector<std::complex<double>> over(const Circuit& circuit, const std::vector<Hertz>& grid,
                                       const OpAmpModel* model) {
  const Network network(circuit);
  std::vector<std::complex<double>> out;
  out.reserve(grid.size());
  for (const Hertz f : grid) {
    stop_if_interrupted();
    out.push_back(network.output(f.rad_s(), model));
  }
  return out;
}

}  // namespace

std::vector<std::complex<double>> network_response(const Circuit& circuit, const std::vector<Hertz>& grid,
                                                   const OpAmpModel& model) {
  return over(circuit, grid, &model);
}

std::vector<std::complex<double>> network_response_ideal(const Circuit& circuit,
                                                         const std::vector<Hertz>& grid) {
  return over(circuit, grid, nullptr);
}

std::vector<std::complex<double>> circuit_response(const Circuit& circuit, const std::vector<Hertz>& grid) {
  std::vector<std::complex<double>> out;
  out.reserve(grid.size());
  for (const Hertz f : grid) out.push_back(circuit.response(f.rad_s()));
  return out;
}

}  // namespace bodesmith::circuit
