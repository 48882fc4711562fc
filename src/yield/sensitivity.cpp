#include "yield/sensitivity.hpp"

#include <algorithm>
#include <cmath>

#include "fpaa/drawn_board.hpp"

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

}  // namespace

Sensitivity sensitivity_of(const Design& design, const Options& options) {
  Sensitivity out;
  if (design.board) {
    const fpaa::DrawnBoard board(*design.board, options.grid);
    for (const auto& slopes : board.sensitivities()) {
      out.db_per_percent.emplace_back();
      out.deg_per_percent.emplace_back();
      for (const std::complex<double>& slope : slopes) {
        out.db_per_percent.back().push_back(0.01 * kDecibelPerNeper * slope.real());
        out.deg_per_percent.back().push_back(to_degrees(0.01 * slope.imag()));
      }
    }
  } else {
    const auto response = [&](Hertz f, std::span<const double> values) { return design.response(f, values); };
    static_cast<circuit::Sensitivity&>(out) =
        circuit::sensitivity_of(response, design.nominal_values(), options.grid);
  }
  for (const Part& part : design.parts) out.limit_percent.push_back(limit_percent_of(part, options.spread));
  return out;
}

}  // namespace bodesmith::yield
