#include "circuit/sensitivity.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "circuit/response.hpp"
#include "circuit/stages/stage_form.hpp"

namespace bodesmith::circuit {
namespace {

constexpr int kBandPoints = 61;

/// worst_db_per_percent() of a circuit whose stages have no equations, by central differences of the network.
std::vector<double> worst_network_sensitivities(const Circuit& circuit, const std::vector<Hertz>& grid) {
  std::vector<double> out;
  Circuit moved = circuit;
  constexpr double kStep = 1e-3;
  for (std::size_t i = 0; i < circuit.parts.size(); ++i) {
    moved.parts[i].realised = circuit.parts[i].realised * (1.0 + kStep);
    const auto up = network_response_ideal(moved, grid);
    moved.parts[i].realised = circuit.parts[i].realised * (1.0 - kStep);
    const auto down = network_response_ideal(moved, grid);
    moved.parts[i].realised = circuit.parts[i].realised;
    double worst = 0.0;
    for (std::size_t k = 0; k < grid.size(); ++k)
      worst = std::max(worst, std::abs(to_decibel(std::abs(up[k] / down[k]))));
    out.push_back(worst * 0.01 / (2.0 * kStep));
  }
  return out;
}

bool has_equations(const Circuit& circuit) {
  return std::all_of(circuit.stages.begin(), circuit.stages.end(),
                     [](const Stage& stage) { return stage.form != nullptr; });
}

}  // namespace

Sensitivity sensitivity_of(const ResponseOfValues& response, std::vector<double> values,
                           std::span<const Hertz> grid) {
  constexpr double kStep = 1e-4;
  constexpr double kPerPercent = 0.01 / (2.0 * kStep);
  Sensitivity out;
  for (double& value : values) {
    const double nominal = value;
    std::vector<double> db, deg;
    for (const Hertz f : grid) {
      value = nominal * (1.0 + kStep);
      const std::complex<double> up = response(f, values);
      value = nominal * (1.0 - kStep);
      const std::complex<double> ratio = up / response(f, values);
      // A null of the response has no slope in dB.
      const bool finite = std::isfinite(ratio.real()) && std::isfinite(ratio.imag()) && std::abs(ratio) > 0.0;
      db.push_back(finite ? to_decibel(std::abs(ratio)) * kPerPercent : 0.0);
      deg.push_back(finite ? to_degrees(std::arg(ratio)) * kPerPercent : 0.0);
    }
    value = nominal;
    out.db_per_percent.push_back(std::move(db));
    out.deg_per_percent.push_back(std::move(deg));
  }
  return out;
}

std::complex<double> stages_response(const Circuit& circuit, Hertz f, std::span<const double> values) {
  std::complex<double> h = 1.0;
  for (const Stage& stage : circuit.stages) {
    if (!stage.form) throw std::logic_error("a stage without equations");
    h *= stage.form->transfer(values.subspan(stage.first_part, stage.part_count)).response(f.rad_s());
  }
  return h;
}

std::vector<double> worst_db_per_percent(const Realised& realised) {
  const Circuit& circuit = realised.circuit;
  const std::vector<Hertz> grid = log_grid(realised.report.band, kBandPoints);
  if (!has_equations(circuit)) return worst_network_sensitivities(circuit, grid);
  std::vector<double> nominal;
  for (const Part& part : circuit.parts) nominal.push_back(part.realised);
  const auto response = [&](Hertz f, std::span<const double> values) {
    return stages_response(circuit, f, values);
  };
  std::vector<double> out;
  for (const std::vector<double>& row : sensitivity_of(response, nominal, grid).db_per_percent) {
    double worst = 0.0;
    for (const double db : row) worst = std::max(worst, std::abs(db));
    out.push_back(worst);
  }
  return out;
}

}  // namespace bodesmith::circuit
