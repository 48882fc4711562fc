#pragma once

#include <optional>
#include <string>
#include <vector>

#include "schematic/netlist.hpp"
#include "synthesis/parts/summing_amplifier.hpp"

namespace bodesmith::synthesis {

/// Adds elements to a netlist; each call gives the place of what it added in its list.
class NetlistMaker {
 public:
  NetlistMaker(schematic::Netlist& to, const Series& resistors, const Series& capacitors)
      : to_(to), resistors_(resistors), capacitors_(capacitors) {}

  std::size_t group = 0;  ///< of what is added next

  std::size_t add_group(std::string title, schematic::Purpose purpose);
  /// The part nearest in the series where `realised` says nothing else.
  int resistor(std::string name, std::string role, std::string from, std::string to, double wanted,
               std::optional<double> realised = {});
  int capacitor(std::string name, std::string role, std::string from, std::string to, double wanted);
  int diode(std::string name, std::string role, std::string anode, std::string cathode);
  /// U1, U2, … where no name is given.
  int opamp(std::string role, std::string plus, std::string minus, std::string out);

  /// What enters a sum: its node; name and role of its resistor.
  struct Weight {
    std::string node, name, role;
  };
  struct Sum {
    int opamp = -1;
    std::vector<int> weights;  ///< -1: a gain of 0, no part
    double noise_gain = 1.0;
  };
  /// The summing amplifier of a design for these gains between its nodes. `letters` begin the names of its other
  /// resistors (Raf, Rab), `tail` ends them, `what` ends their roles.
  Sum sum(const std::vector<Weight>& weights, const std::vector<double>& gains, const SummingDesign& design,
          const std::string& letters, const std::string& tail, const std::string& what, std::string role,
          const std::string& plus, const std::string& minus, const std::string& out);

  /// A precision rectifier, -max(0, V(from) + V(reference)/ratio), with the pair of equal resistors whose reference resistor is
  /// nearest the series; `ratio` above 1 takes a small share of the reference.
  struct Rectifier {
    int opamp = -1;
    double ratio = 0.0;  ///< realised
  };
  Rectifier rectifier(const std::string& node, const std::string& role, const std::string& from,
                      const std::string& reference, double ratio);
  /// An inverting sum, or two: V(out) = sum of gains V(from). What counts with a positive gain passes a sum of its own (`inverted`)
  /// first, so that every term ends at a virtual ground: a rectifier that rests is no source, only its feedback's
  /// resistance. Where that sum would reach the op-amp's swing it is made smaller, and counts for more after it. `rows`: for each
  /// point that counts the terms' voltages and, last, what the sum should be. The place of its op-amp.
  int signed_sum(const std::vector<std::string>& from, const std::vector<double>& gains,
                 const std::vector<std::vector<double>>& rows, const std::string& role,
                 const std::string& out, const std::string& inverted);

 protected:
  schematic::Netlist& to_;
  const Series& resistors_;
  const Series& capacitors_;

 private:
  /// Returns what the realised resistors make of the gains, all below 0.
  std::vector<double> inverting_sum(const std::vector<std::string>& from, const std::vector<double>& gains,
                                    const std::vector<std::vector<double>>& rows, const std::string& role,
                                    const std::string& out);
  int part(schematic::Part one);
};

}  // namespace bodesmith::synthesis
