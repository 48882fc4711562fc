#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "base/units.hpp"
#include "fpaa/switches.hpp"

namespace bodesmith::fpaa {

/// An op-amp with one pole: dV/dt = 2 pi gain_bandwidth (-v - V/gain), v at its inverting input, the other
/// input at ground. Not publicly known for this chip: assumptions that the user may set.
struct OpAmpModel {
  Hertz gain_bandwidth{20e6};
  double gain = 1e5;
};

/// What the switches of a stage make of their inputs' samples, by charge balance alone: the source of every
/// CAM's equation, for checking them and for what slow op-amps leave.
///
/// Within a phase the charge at every inverting input is constant, so that v = (Q + sum C V_other)/sum C, and
/// the op-amps settle by the matrix exponential of that linear system over the phase's length. For one op-amp
/// this is the well-known factor
///   eps = exp(-2 pi beta gain_bandwidth t),   beta = C_feedback/(C_feedback + C_input),   t = T/2
/// of the step that the phase has to make (Gregorian and Temes, Analog MOS Integrated Circuits for Signal
/// Processing, 1986, section 6.6): V = V_ideal + eps (V_before - V_ideal). Switches are taken to have no
/// resistance, the gap between the phases no length.
class ChargeBalance {
 public:
  ChargeBalance(const StageSwitches& stage, const OpAmpModel& opamp, Hertz clock);

  /// From the samples of `input` (from 1; each held for a whole period, from phase 1 on) to the output at the
  /// end of its phase (phase 1 for a whole-period output).
  std::complex<double> response(RadPerSecond w, int input = 1) const;
  /// The output in the phase that is asked for.
  std::complex<double> response_in_phase(RadPerSecond w, int phase, int input) const;

 private:
  struct PhaseMap {
    Eigen::MatrixXd state;  ///< charges of the capacitors, then output voltages: end of phase from its start
    Eigen::MatrixXd input;
  };
  PhaseMap map_of(const StageSwitches& stage, const OpAmpModel& opamp, int phase, double length_s) const;

  PhaseMap first_, second_;
  Eigen::Index output_ = 0;  ///< index of the stage's output in the state
  int phase_ = 1;
  Hertz clock_;
};

}  // namespace bodesmith::fpaa
