#pragma once

#include <optional>
#include <vector>

#include "lti/sections.hpp"

namespace bodesmith {

/// Answers of a chain at rest to a unit step and to a unit impulse at t = 0, exact at the times (matrix exponential).
struct TimeResponse {
  std::vector<double> time_s;
  std::vector<double> step;
  std::vector<double> impulse;  ///< without the part below
  /// What goes straight through: the impulse's answer has a Dirac of this weight at the delay.
  double direct = 0.0;

  /// Of the step, where the chain has a finite DC gain other than 0.
  struct Figures {
    double final_value = 0.0;
    double rise_s = 0.0;             ///< from 10 to 90 % of the final value
    double overshoot_percent = 0.0;  ///< beyond the final value
    double settling_s = 0.0;         ///< until it stays within 2 %, from t = 0
  };
  std::optional<Figures> figures;  ///< whatever the times are
};

/// Long enough for the slowest pole to fall to 1e-3, plus the delay.
double response_duration_s(const Sections& sections);
/// `count` even times from 0 to `duration_s`, both included.
TimeResponse time_response(const Sections& sections, double duration_s, int count);

}  // namespace bodesmith
