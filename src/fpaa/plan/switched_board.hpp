#pragma once

#include <span>
#include <string>
#include <vector>

#include "fpaa/network/periodic_network.hpp"
#include "fpaa/plan/plan.hpp"
#include "fpaa/plan/plan_graph.hpp"

namespace bodesmith::fpaa {

/// A plan as its switches make it (facts of each CAM: Cam::switches), with the capacitors that the plan says or
/// with others. The input is a voltage that moves at the pin, the output the waveform at the pin.
class SwitchedBoard {
 public:
  /// Throws DesignError for a plan whose wires are wrong or loop, with a CAM whose switches are not known, or with
  /// clocks without a manageable common period. The plan must outlive it. `with_noise`: for noise_density(); other figures cost more then
  /// (PeriodicNetworks).
  explicit SwitchedBoard(const Plan& plan, bool with_noise = false);

  /// Capacitors of all CAMs one behind the other, in the plan's order.
  const std::vector<double>& nominal_units() const { return units_; }
  /// "chip1.Section1a.Ca".
  const std::vector<std::string>& names() const { return names_; }
  void set_units(std::span<const double> units);

  /// From pin to pin, at the sine's own frequency.
  Complex gain(RadPerSecond w) const { return networks_.gain(w); }
  /// The product of the CAMs' z-transfers alone: what the capacitors make of samples.
  Complex sampled(RadPerSecond w) const;
  /// Every op-amp, [node of graph()][op-amp].
  std::vector<std::vector<PeriodicNetworks::NodeSize>> nodes(RadPerSecond w) const;
  /// PeriodicNetworks::components().
  std::vector<Complex> components(RadPerSecond sine, std::span<const RadPerSecond> lines) const {
    return networks_.components(sine, lines);
  }
  /// One-sided, in kT/C_u a hertz at the output pin, [node of graph()]; of the nominal capacitors (not after set_units). Each stage's
  /// switches by themselves: what the next stage samples of their motion within a phase is left out (some percent).
  std::vector<double> noise_density(RadPerSecond w) const;

  const PlanGraph& graph() const { return graph_; }
  Hertz fastest_clock() const;
  /// Pieces of waveforms that a frequency costs (some 0.2 us each).
  std::size_t pieces() const { return networks_.pieces(); }
  /// Instants that nodes() looks at (some 10 ns each).
  std::size_t instants() const { return networks_.instants(); }

 private:
  ClockedNetwork clocked(std::size_t node, std::span<const double> units, bool with_noise) const;

  PlanGraph graph_;
  SlowParts slow_;
  std::vector<std::size_t> first_capacitor_;  ///< of each node
  std::vector<double> units_, drawn_;
  std::vector<std::string> names_;
  PeriodicNetworks networks_;
  std::vector<std::size_t> network_of_;   ///< of each node
  std::vector<SwitchedNetwork> counted_;  ///< likewise, at the plan's capacitors
};

}  // namespace bodesmith::fpaa
