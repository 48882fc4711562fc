#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "base/units.hpp"
#include "fpaa/cams/switches.hpp"
#include "fpaa/device/mismatch.hpp"
#include "schematic/netlist.hpp"

namespace bodesmith::fpaa {

/// A switched-capacitor circuit: a netlist of capacitors, op-amps and contacts that phases of clocks close, with what is outside of it.
struct SwitchedCircuit {
  struct Phase {
    std::string node;  ///< Contact::control
    int clock = 0;     ///< index, from 0
    int phase = 1;     ///< 1 or 2: first and second half of the clock's period
  };
  schematic::Netlist netlist;
  std::vector<std::string> inputs;
  std::string output;  ///< of an op-amp
  std::vector<Phase> phases;
  double switch_s = 0.0;  ///< resistance of a closed switch times the unit of capacitance
};

/// A stage's circuit: nodes in1 … out p1 p2 …, n1 … at the inverting inputs, u1 … behind switches; capacitors in units.
SwitchedCircuit circuit_of(const StageSwitches& stage, const SlowParts& slow = {});

/// The same with its nodes counted, 0 is ground. Op-amps have any gain, and all has settled when a switch moves.
struct SwitchedNetwork {
  struct Capacitor {
    int a = 0, b = 0;
    double size = 0.0;
  };
  /// Closed in one phase of one clock.
  struct Switch {
    int a = 0, b = 0;
    int clock = 0;  ///< index, from 0
    int phase = 1;  ///< 1 or 2: first and second half of the clock's period
  };
  struct OpAmp {
    int plus = 0, minus = 0, out = 0;
    Hertz gain_bandwidth{0.0};  ///< 0: none is known, it follows at once
    double noise_per_hz = 0.0;  ///< one-sided density at its input
    double late_s() const { return gain_bandwidth.value > 0.0 ? 1.0 / gain_bandwidth.rad_s().value : 0.0; }
  };
  int nodes = 1;  ///< ground among them
  std::vector<Capacitor> capacitors;
  std::vector<Switch> switches;
  std::vector<OpAmp> opamps;
  std::vector<int> inputs;  ///< nodes held at the inputs' voltages
  int output = 0;           ///< index of the op-amp that is read outside
  double switch_s = 0.0;    ///< SwitchedCircuit::switch_s

  /// Throws DesignError where the netlist has other elements, or no op-amp at the output.
  SwitchedNetwork(const SwitchedCircuit& circuit);
};

/// A network while its switches stand still. What is conserved is the charge of every group of joined nodes that
/// nothing holds; with q those charges and u the inputs, all at the same instant,
///   V(t) = volts_q q + volts_u u(t)      outputs of the op-amps (opamps x charges, opamps x inputs)
///   Q(t) = nodes_q q + nodes_u u(t)      charge of the plates at each node (nodes x charges, nodes x inputs)
/// (charge conservation at every virtual ground; e.g. Johns and Martin, Analog Integrated Circuit Design, 1997,
/// section 10.2). In the next position of the switches a group's charge is the sum of Q over its nodes.
struct ChargeMap {
  std::vector<int> charge_of;  ///< of each node: the index of its group's charge; -1: its voltage is held
  Eigen::Index charges = 0;
  Eigen::MatrixXd volts_q, volts_u;
  Eigen::MatrixXd nodes_q, nodes_u;
  /// Covariance of the plates' charge that the noise of the switches (of equal resistance) leaves when they open, in
  /// kT times the unit of capacitance (nodes x nodes).
  Eigen::MatrixXd noise;

  /// Of the op-amps with a noise of their own, x their outputs in addition to the above while no switch moves:
  ///   dx/dt = 2 pi f (v(plus) - v(minus) + e) = A x + 2 pi f e,   e white.
  struct OpAmpNoise {
    std::vector<Eigen::Index> of;  ///< their indices
    Eigen::MatrixXd volts, nodes;  ///< outputs of all op-amps, and charges of the plates at each node, from x
    Eigen::MatrixXd settling_s;    ///< -1/A
    double slowest_s = 0.0;        ///< longest time constant
    Eigen::MatrixXd covariance;    ///< of x, in kT over the unit of capacitance
  };
  OpAmpNoise opamps;

  /// Where op-amps or switches are slow: [outputs of op-amps, Q] stay behind, to the first order in their time constants, by
  ///   -late d/dt [Q, outputs of op-amps]       (late: opamps + nodes x nodes + opamps, s)
  Eigen::MatrixXd late;
};

/// Throws DesignError where the voltages are not determined: an op-amp without feedback, an input joined to ground.
/// `closed`: of each switch.
ChargeMap charge_map(const SwitchedNetwork& network, const std::vector<bool>& closed, bool with_noise);

/// Sums of the charges at nodes for the groups of `next`: (next.charges x nodes).
Eigen::MatrixXd regrouped(const ChargeMap& next);

}  // namespace bodesmith::fpaa
