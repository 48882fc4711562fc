#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hysteresis/model_type.hpp"

namespace bodesmith::hysteresis {

struct IdentifyOptions {
  std::uint64_t seed = 1;
  /// `best` (the better method, default) or `paper` (what the paper does).
  std::string method = "best";
  /// Size of the model where it has one: plays, exponential operators, Preisach or KP levels. 0: the type's
  /// default.
  int size = 0;
  /// Operating frequency where the model asks for it; 0: taken from the record.
  double frequency_hz = 0.0;
  /// Seconds at the start of every record that are simulated but not fitted.
  double skip_s = 0.0;
  /// Ask for the asymmetric form where the type has one (Prandtl-Ishlinskii: dead zones behind the plays).
  bool asymmetric = false;
  /// Effort of a stochastic search, relative to its default.
  double effort = 1.0;

  bool as_in_paper() const { return method == "paper"; }
};

/// A parameter with its standard deviation, from the residual's Jacobian at the solution, widened for the
/// residual's own correlation (effective sample size).
struct ParameterUncertainty {
  std::string name;  ///< e.g. "w[3]"
  double value = 0.0;
  double standard_deviation = 0.0;
};

/// gain u + offset.
struct Scaling {
  double gain = 1.0;
  double offset = 0.0;

  double operator()(double u) const { return offset + gain * u; }
};

/// What was found: y = output(H[input(u)]), H the model.
struct Identified {
  Model model;
  Scaling input;
  Scaling output;
  std::string method;  ///< in words
  std::vector<ParameterUncertainty> uncertainty;
  std::vector<std::string> notes;  ///< what a person must know (not identifiable, limits met)
  bool converged = true;           ///< false: the search stopped at its limit, not at a minimum
  double compute_s = 0.0;
};

}  // namespace bodesmith::hysteresis
