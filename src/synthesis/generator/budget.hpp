#pragma once

#include <string>
#include <vector>

#include "synthesis/generator/circuit.hpp"

namespace bodesmith::generator {

/// What multipliers and op-amps do wrong at rest. The figures are parameters, to be set for the parts that
/// are bought:
///   W = (X + input_offset)(Y + input_offset)/(U (1 + scale_error)) (1 + nonlinearity) + Z + output_offset.
/// An offset at one input is the feedthrough of the other: input_offset/U of it comes through.
struct ErrorLimits {
  double input_offset_v = 3e-3;
  double output_offset_v = 5e-3;
  double scale_percent = 0.5;         ///< of U, after trimming
  double nonlinearity_percent = 0.2;  ///< of the product
  double opamp_offset_v = 0.5e-3;
  double resistor_percent = 0.1;
  double switch_ohm_percent = 20.0;

  /// Every departure of a multiplier at its limit, all positive.
  MultiplierDeviation multiplier_at_limit() const {
    return {input_offset_v, input_offset_v, output_offset_v, scale_percent / 100.0,
            nonlinearity_percent / 100.0};
  }
};

/// One cause, alone, at its limit: greatest change of d over x in [0, 1] and the strokes that are looked at, percent of the range
/// of x.
struct BudgetLine {
  std::string cause;
  std::vector<double> percent;  ///< one a branch
};

struct Budget {
  ErrorLimits errors;
  std::vector<BudgetLine> lines;      ///< largest first
  std::vector<double> rss_percent;    ///< root of the sum of squares, one a branch
  std::vector<double> worst_percent;  ///< sum
};

/// Every multiplier with all its departures at their limits.
schematic::Deviations multipliers_at_limit(const DisturbanceCircuit& layout, const ErrorLimits& errors);

Budget make_budget(const DisturbanceCircuit& layout, const ErrorLimits& errors = {});

}  // namespace bodesmith::generator
