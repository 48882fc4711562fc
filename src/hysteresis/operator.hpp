#pragma once

#include <memory>

namespace bodesmith::hysteresis {

/// A scalar operator with memory, y(t) = H[u](t), driven along a piecewise monotone input. Nothing allocates
/// in step() and peek(). Rate-independent operators ignore dt_s.
class Operator {
 public:
  virtual ~Operator() = default;
  virtual std::unique_ptr<Operator> clone() const = 0;

  /// Forgets everything and rests under the input u; returns the output there.
  virtual double reset(double u) = 0;
  /// The input moves monotonically from where it was to u within dt_s seconds; returns the output at its end.
  virtual double step(double u, double dt_s) = 0;
  /// What step() would return, without taking the step.
  virtual double peek(double u, double dt_s) const = 0;
  virtual bool rate_independent() const = 0;
};

}  // namespace bodesmith::hysteresis
