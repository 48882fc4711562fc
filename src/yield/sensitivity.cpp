#include "yield/sensitivity.hpp"

#include <algorithm>
#include <cmath>

#include "fpaa/plan/drawn_board.hpp"
#include "schematic/analysis/sensitivity.hpp"

namespace bodesmith::yield {
namespace {

double limit_percent_of(const Part& part, const Spread& spread) {
  const double kelvin =
      std::max(std::abs(spread.temperature_low_c - 25.0), std::abs(spread.temperature_high_c - 25.0));
  switch (part.kind) {
    case Part::Kind::resistor:
      return spread.resistor_percent + spread.resistor_ppm_per_k * kelvin * 1e-4;
    case Part::Kind::capacitor:
      return spread.capacitor_percent + spread.capacitor_ppm_per_k * kelvin * 1e-4;
    case Part::Kind::switched_capacitor:
      return 300.0 * spread.mismatch.relative_sigma(part.nominal);
  }
  return 0.0;
}

using Slopes = std::vector<std::vector<std::complex<double>>>;  // d ln H/d ln part, [part][frequency]

Slopes circuit_slopes(const schematic::Netlist& netlist, const std::vector<Hertz>& grid) {
  const schematic::Equations equations(netlist, {.ideal_opamps = true});
  Slopes out(netlist.parts.size());
  for (const Hertz f : grid) {
    const auto here = schematic::log_sensitivities(equations, out.size(), f.rad_s());
    for (std::size_t i = 0; i < out.size(); ++i) out[i].push_back(here[i]);
  }
  return out;
}

/// By central differences: a product of switched-capacitor stages.
Slopes product_slopes(const Design& design, const std::vector<Hertz>& grid) {
  constexpr double kStep = 1e-4;
  std::vector<double> values = design.nominal_values();
  Slopes out;
  for (double& value : values) {
    const double nominal = value;
    out.emplace_back();
    for (const Hertz f : grid) {
      value = nominal * (1.0 + kStep);
      const std::complex<double> up = design.response(f, values);
      value = nominal * (1.0 - kStep);
      const std::complex<double> ratio = std::log(up / design.response(f, values)) / (2.0 * kStep);
      out.back().push_back(std::isfinite(ratio.real()) && std::isfinite(ratio.imag()) ? ratio : 0.0);
    }
    value = nominal;
  }
  return out;
}

Slopes log_slopes(const Design& design, const std::vector<Hertz>& grid) {
  if (design.board) return fpaa::DrawnBoard(*design.board, grid).sensitivities();
  return design.netlist ? circuit_slopes(*design.netlist, grid) : product_slopes(design, grid);
}

}  // namespace

Sensitivity sensitivity_of(const Design& design, const Options& options) {
  Sensitivity out;
  for (const auto& slopes : log_slopes(design, options.grid)) {
    out.db_per_percent.emplace_back();
    out.deg_per_percent.emplace_back();
    for (const std::complex<double>& slope : slopes) {
      out.db_per_percent.back().push_back(0.01 * kDecibelPerNeper * slope.real());
      out.deg_per_percent.back().push_back(to_degrees(0.01 * slope.imag()));
    }
  }
  for (const Part& part : design.parts) out.limit_percent.push_back(limit_percent_of(part, options.spread));
  return out;
}

}  // namespace bodesmith::yield
