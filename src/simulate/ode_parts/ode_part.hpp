#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "chain/kernel.hpp"

namespace bodesmith::simulate {

/// A signal and its slope (per second) at one time.
struct SlopedValue {
  double value = 0.0;
  double slope = 0.0;
};

/// What a walk along the chain is for.
enum class Walk {
  rates,    ///< rates of the states; slopes of signals are not looked at
  slopes,   ///< also slopes, for memories and their events
  restart,  ///< at a corner or event: jumps are taken, and directions chosen by the slopes
};

/// One block inside an ODE x' = f(t, x) made of neighbouring blocks (ode_system.hpp). `x`, `dx` and `z` are
/// this part's own states.
class OdePart {
 public:
  virtual ~OdePart() = default;

  virtual std::size_t order() const { return 0; }
  /// Event functions that CVODE watches for a zero.
  virtual std::size_t events() const { return 0; }
  /// Whether slopes of its input matter even between restarts.
  virtual bool needs_slopes() const { return false; }
  /// Bound on the fastest rate, rad/s.
  virtual double fastest_rate() const { return 0.0; }
  /// No path from its input to its output but through states.
  virtual bool strictly_proper() const { return false; }

  /// The output at the first instant for the input u, `still`: at rest under it (states then set so).
  virtual double start(double t, double u, bool still, double* x) = 0;
  /// Rates into dx; the output and its slope. Keeps the input for what follows.
  SlopedValue walk(double t, SlopedValue in, const double* x, double* dx, Walk purpose) {
    in_ = in;
    return pass(t, in, x, dx, purpose);
  }
  /// The output where it follows from the input's value and the states alone: not of memories.
  virtual std::optional<double> output(double /*t*/, double /*u*/, const double* /*x*/) const {
    return std::nullopt;
  }
  /// This part's share of (I - gamma df/dx) z = b, after a walk there: z comes in as b, `du` is what the
  /// states in front change of its input; returns what they and its own change of its output.
  virtual double newton(double gamma, double du, const double* x, double* z) = 0;

  virtual void event_values(const double* /*x*/, double* /*g*/) const {}
  /// The step is taken, up to the left of a corner: memories move to where their input now is.
  virtual void commit() {}
  /// Before solving starts again: +1/-1 where an own event function has crossed upwards/downwards; null at a
  /// corner of the input.
  virtual void cross(const int* /*crossings*/, double* /*x*/) {}

  double input() const { return in_.value; }

 protected:
  virtual SlopedValue pass(double t, SlopedValue in, const double* x, double* dx, Walk purpose) = 0;
  SlopedValue in_;
};

/// Whether a block may be part of an ODE: everything but pure delays, clocked blocks and memory that depends
/// on the rate (but for a slew limit and late branches).
bool can_stand_in_ode(const chain::Kernel& kernel);
/// `kernel` can stand in an ODE, and outlives the part.
std::unique_ptr<OdePart> make_ode_part(const chain::Kernel& kernel);

// The kinds, each in a file of its own.
std::unique_ptr<OdePart> make_dynamics_part(const StateSpace& linear, const chain::OdeKernel* bend);
std::unique_ptr<OdePart> make_curve_part(const chain::CurveKernel& curve);
std::unique_ptr<OdePart> make_source_part(const chain::SourceKernel& source);
std::unique_ptr<OdePart> make_memory_part(chain::MemoryKernel& memory);
std::unique_ptr<OdePart> make_branch_part(const chain::MemoryKernel& memory);
std::unique_ptr<OdePart> make_slew_part(chain::MemoryKernel& memory);

}  // namespace bodesmith::simulate
