#pragma once

#include <optional>
#include <vector>

#include "base/documents/json_fwd.hpp"
#include "synthesis/generator/budget.hpp"
#include "synthesis/generator/circuit.hpp"

namespace bodesmith::generator {

/// disturbance.sub (or disturbance_amplitude.sub) in ngspice against the polynomials and against what the program predicts: at rest at
/// the table's strokes, between and below them.
struct DisturbanceCheck {
  double static_percent =
      0.0;  ///< greatest |d - wanted| over x in [0, 1], all branches and strokes, percent of the range of x
  double static_against_program = 0.0;  ///< the same against the program's own figures
  /// multipliers_off(), static: greatest |d - wanted| in ngspice, by the program, and the greatest difference of
  /// the two, percent of range.
  double off_percent = 0.0, off_predicted_percent = 0.0, off_against_program = 0.0;

  struct Dynamic {
    Hertz frequency;
    double alpha = 1.0;            ///< the stroke
    double rms_percent = 0.0;      ///< second period of a triangle, slope detector and switch included
    double peak_percent = 0.0;     ///< greatest |error| of it
    double late_share = 0.0;       ///< share of the period in which the branch is the wrong one
    double delay_s = 0.0;          ///< of the slope detector, mean of both reversals
    double rms_off_percent = 0.0;  ///< with multipliers_off()
  };
  std::vector<Dynamic> dynamic;

  /// One change of branch with x at rest where the old branch is greatest.
  struct Change {
    double x = 0.0;
    double delay_s =
        0.0;  ///< from the control until 90 % of the change at the common node; 0 when there is none
    double glitch_percent = 0.0, predicted_percent = 0.0;  ///< while both contacts are open
  };
  std::optional<Change> change;
};

/// Static sweeps of every branch, a triangle of 0 to 1 V at each frequency through the slope detector (with amplitude
/// gains at the last one also at the table's middle stroke), one change of branch. Needs ngspice.
DisturbanceCheck check_disturbance(const DisturbanceCircuit& layout, const std::vector<Hertz>& triangles);

/// "ngspice" of layout.json.
Json to_json(const DisturbanceCheck& check);

}  // namespace bodesmith::generator
