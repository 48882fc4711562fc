#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "schematic/analysis/equations.hpp"

namespace bodesmith::schematic {

/// A netlist in time, driven at its input, by CVODE (BDF, restarted where the input has a corner): comparators, gates and
/// contacts act, diodes conduct, op-amps slew and saturate. The equations f(x) + d/dt q(x) = 0 are solved for x' at every
/// evaluation,
///   M x' = -f(x, t) - (dq/d input) input',   M = dq/dx,
/// and Newton's method solves (M + gamma (df/dx + (d^2q/dx^2) x')) z = M b, both by sparse LU.
/// So that M has an inverse every node has a femtofarad to ground and every op-amp an ohm at least; a node that an ideal
/// source holds (multiplier, source, level) has no balance of currents and follows within a nanosecond. Op-amps are real
/// ones: nullors have no state.
class InTime {
 public:
  using Input = std::function<double(double)>;
  /// Assumptions::position and ::switching count for nothing.
  InTime(const Netlist& netlist, Input input, const Assumptions& assumptions = {});
  ~InTime();

  /// State from which run_to() begins: nodes by name, all others at 0.
  void begin(double t, const std::map<std::string, double>& volts = {});
  /// To `stop`, the next corner of the input; `step` sees the ends of every step.
  void run_to(double stop, const std::function<void(double from, double to)>& step = {});
  /// The same, no further than where a node first passes 0 upwards; none: it does not.
  std::optional<double> rises(const std::string& node, double stop);
  /// V(node) within the last step.
  double volts(const std::string& node, double t) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace bodesmith::schematic
