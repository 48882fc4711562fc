#pragma once

#include <functional>
#include <memory>
#include <string>

#include "schematic/analysis/equations.hpp"

namespace bodesmith::schematic {

/// A netlist in time, driven at its input, by CVODE (BDF, restarted where the input has a corner). The equations
/// f(x) + d/dt q(x) = 0 are solved for x' at every evaluation:
///   (dq/dx) x' = -f(x, t) - (dq/d input) input'.
/// So that dq/dx has an inverse every node has a femtofarad to ground and every op-amp an ohm at least; a node that an ideal
/// source holds (multiplier, source) has no balance of currents. Op-amps are real ones: nullors have no state. For circuits that
/// stay within their limits: diodes and comparators driven hard are more than its steps can follow.
class InTime {
 public:
  using Input = std::function<double(double)>;
  InTime(const Netlist& netlist, Input input, const Assumptions& assumptions = {});
  ~InTime();

  /// State from which run_to() begins: nodes by name, all others at 0.
  void begin(double t, const std::map<std::string, double>& volts = {});
  /// To `stop`, the next corner of the input; `step` sees the ends of every step.
  void run_to(double stop, const std::function<void(double from, double to)>& step = {});
  /// V(node) within the last step.
  double volts(const std::string& node, double t) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace bodesmith::schematic
