#pragma once

#include "fpaa/cams/transfer_function.hpp"
#include "fpaa/controller.hpp"

namespace bodesmith::fpaa {

struct PolynomialError {
  double max_percent = 0.0;  ///< of the stroke (x = 1)
  double rms_percent = 0.0;
};

/// d(x) as a way makes it, against d(x), over x in [0, 1] and both branches. On the board x = 0 ... 1 is -3
/// ... +3 V for the look-up (all 256 codes) and 0 ... 3 V for the multipliers.
PolynomialError polynomial_error(const Disturbance& disturbance, PolynomialBy by,
                                 double outside_error_percent);

/// A branch as a look-up table: input -3 ... +3 V is x = 0 ... 1, output 3 V is d = `scale`.
struct BranchTable {
  LookupTable table;
  double scale = 1.0;
};
/// Refused for a branch that is 0 everywhere.
Outcome<BranchTable> branch_table(const Disturbance& disturbance, Disturbance::Branch branch);
/// The function that a table of this scale imitates, in volts.
double branch_volts(const Disturbance& disturbance, Disturbance::Branch branch, double scale, double input_v);

}  // namespace bodesmith::fpaa
