#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "lti/state_space.hpp"

namespace bodesmith::tracking {

/// Compensators, drive path and stage path, one behind the other:
///   c = C_a{ascending} + C_d{descending},  v = D{x - c},  y = P{v + stage}.
/// States in that order.
class SwitchedSystem {
 public:
  /// What goes in: reference, both generator waveforms, and what the stage adds.
  struct Inputs {
    double x = 0.0;
    double ascending = 0.0;
    double descending = 0.0;
    double stage = 0.0;
  };
  static constexpr std::size_t kInputs = 4;
  struct Outputs {
    double drive = 0.0;         ///< v
    double displacement = 0.0;  ///< y
  };

  SwitchedSystem(StateSpace ascending, StateSpace descending, StateSpace drive, StateSpace path);

  std::size_t order() const { return front() + path_.order(); }
  /// States in front of the stage.
  std::size_t front() const { return ascending_.order() + descending_.order() + drive_.order(); }

  /// The switch behind the compensators lets only one of them through.
  void switch_to(bool rising) { open_ = {rising, !rising}; }

  /// Rates of all states into dx.
  Outputs evaluate(const Inputs& in, const double* x, double* dx) const;
  /// dv/dt, after evaluate() filled dx.
  double drive_slope(const Inputs& slopes, const double* dx) const;

  /// The system as it stands: df/dx (row-major) and the columns by which the inputs enter, in their order.
  struct Matrices {
    std::vector<double> a;
    std::array<std::vector<double>, kInputs> b;
  };
  Matrices matrices() const;

 private:
  StateSpace ascending_, descending_, drive_, path_;
  std::array<bool, 2> open_ = {true, true};
};

}  // namespace bodesmith::tracking
