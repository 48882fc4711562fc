#include "circuit/noise.hpp"

#include <cmath>

#include "circuit/network.hpp"

namespace bodesmith::circuit {
namespace {

constexpr double kBoltzmann = 1.380649e-23;
constexpr double kKelvin = 300.15;

/// V(out) for a unit right-hand side in each row.
Eigen::VectorXcd ways_to_output(const Network& network, RadPerSecond w, const OpAmpModel& model) {
  SparseSystem s = network.system(w, &model);
  s.transpose();
  s.b.setZero();
  s.b(network.node("out")) = 1.0;
  return solve_sparse(s);
}

std::complex<double> way(const Eigen::VectorXcd& ways, int node) {
  return node < 0 ? 0.0 : ways(node);
}

}  // namespace

std::vector<double> output_noise(const Circuit& circuit, const OpAmpModel& model,
                                 const std::vector<Hertz>& grid, bool flicker) {
  const Network network(circuit);
  std::vector<double> out;
  for (const Hertz f : grid) {
    const Eigen::VectorXcd ways = ways_to_output(network, f.rad_s(), model);
    double power = 0.0;
    for (const Part& part : circuit.parts) {
      if (part.kind != Part::Kind::resistor) continue;
      const double current = 4.0 * kBoltzmann * kKelvin / part.realised;
      power += current * std::norm(way(ways, network.node(part.from)) - way(ways, network.node(part.to)));
    }
    const double flicker_factor = flicker ? 1.0 + model.voltage_noise_corner_hz / f.value : 1.0;
    const double voltage = std::pow(model.voltage_noise_v_per_rthz, 2) * flicker_factor;
    const double current = std::pow(model.current_noise_a_per_rthz, 2);
    const double resistance =
        4.0 * kBoltzmann * kKelvin * model.output_resistance_ohm / std::norm(model.open_loop(f.rad_s()));
    for (size_t i = 0; i < circuit.opamps.size(); ++i) {
      const OpAmp& opamp = circuit.opamps[i];
      power += (voltage + resistance) * std::norm(ways(network.nodes() + static_cast<Eigen::Index>(i)));
      power += current * (std::norm(way(ways, network.node(opamp.plus))) +
                          std::norm(way(ways, network.node(opamp.minus))));
    }
    out.push_back(std::sqrt(power));
  }
  return out;
}

double output_noise_rms(const Circuit& circuit, const OpAmpModel& model, Band band, bool flicker) {
  // The density bends slowly: trapezoids in log frequency.
  const std::vector<Hertz> grid = log_grid(band, 121);
  const std::vector<double> density = output_noise(circuit, model, grid, flicker);
  double sum = 0.0;
  for (size_t i = 1; i < grid.size(); ++i) {
    const double a = density[i - 1] * density[i - 1] * grid[i - 1].value,
                 b = density[i] * density[i] * grid[i].value;
    sum += 0.5 * (a + b) * std::log(grid[i].value / grid[i - 1].value);
  }
  return std::sqrt(sum);
}

double worst_output_offset(const Circuit& circuit, const OpAmpModel& model) {
  const Network network(circuit);
  const Eigen::VectorXcd ways = ways_to_output(network, {0.0}, model);
  double out = 0.0;
  for (size_t i = 0; i < circuit.opamps.size(); ++i) {
    const OpAmp& opamp = circuit.opamps[i];
    out += model.offset_v * std::abs(ways(network.nodes() + static_cast<Eigen::Index>(i)));
    out += model.bias_current_a *
           (std::abs(way(ways, network.node(opamp.plus))) + std::abs(way(ways, network.node(opamp.minus))));
  }
  return out;
}

}  // namespace bodesmith::circuit
