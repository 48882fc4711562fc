#pragma once

#include <string>
#include <vector>

#include "fpaa/device/mismatch.hpp"
#include "fpaa/plan/plan.hpp"
#include "schematic/writers/spice_library.hpp"

namespace bodesmith::fpaa {

/// What a switched-capacitor netlist needs; op-amps and switches that a plan knows are that plan's. None of it is publicly known for
/// this chip.
struct NetlistParts {
  double unit_capacitance_f = NoiseModel().unit_capacitance_f;
  /// Op-amps and switches as quick as those that follow at once in the plan's figures (a thousandth of a point, at 20 kHz).
  double switch_on_ohm = 20.0;
  double switch_off_ohm = 1e15;
  /// Stray capacitance to ground, in units, of every inverting input and of every plate behind switches. The
  /// stages are insensitive to it; without any, an inverting input whose capacitors are all open between the
  /// phases has no voltage, and a simulator's matrix no solution.
  double stray_units = 1e-3;
  schematic::OpAmpModel opamp = schematic::OpAmpModel::one_pole(Hertz{1e9}, 1e7);
  /// Both phases of a clock end this share of a period before the other begins. It is as if they sampled so much
  /// earlier, which is an error of pi f/fc of it: a chip's are nanoseconds.
  double gap = 0.0005;
};

/// board.sub: the plan as switched capacitors, `.subckt board in out`, ground node 0 (the chips' differential
/// signals drawn single-ended, about 0 V instead of 1.5 V). Each CAM is a subcircuit made from the description
/// of its switches (cams/switches.hpp), the whole a schematic::SpiceLibrary that `sc` reads back; a switch is a conductance that
/// goes with its phase's node from 0 to 1 V; each clock has two phases that do not overlap, all clocks start at t = 0 with
/// phase 1. Op-amps have one pole and an ideal output. Throws DesignError for a plan with a CAM whose switches are not known.
std::string board_netlist(const Plan& plan, const NetlistParts& parts, const std::string& title);

/// A CAM of such a netlist.
struct NetlistStage {
  std::string name;  ///< "chip1.Section1a"
  const PlacedCam* cam = nullptr;
  double period_s = 0.0;            ///< of its clock
  std::vector<std::string> inputs;  ///< nodes; "0" where nothing is wired
  std::string output;
};
/// The node at the output of the CAM of this name.
std::string output_node(const std::string& name);
/// Such a netlist: CAMs and clocks join `top`. `what` is said to be in it.
std::string switched_library(schematic::Subcircuit top, const std::string& what,
                             const std::vector<NetlistStage>& stages, const NetlistParts& parts,
                             const std::string& title);

/// board.cir: a sine in the middle of the plan's band through it, for ngspice; nearer to the band's upper end where
/// the fastest clock would turn too often.
std::string board_deck(const Plan& plan, const std::string& title);

/// Options that ngspice needs for capacitors of some fF (its default accuracy is a charge of 1e-14 C).
std::string board_deck_options();

}  // namespace bodesmith::fpaa
