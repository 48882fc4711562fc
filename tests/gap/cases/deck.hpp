#pragma once

#include <functional>
#include <string>
#include <vector>

/// Decks for ngspice: two-ports in series, each between ideal buffers, driven by a sampled input. Only forms
/// that ngspice takes at their word are used (tanh, min, max, products; no ^, no LIMIT).
namespace hidden {

/// Text of a two-port from node `in` to node `out`; `id` makes its inner names its own.
using TwoPort = std::function<std::string(const std::string& in, const std::string& out, int id)>;

/// An op-amp with one pole, a slew rate, rails that stop the integrating node, and an input offset.
struct OpAmp {
  double gain_bandwidth_hz = 0.0;
  double slew_v_per_s = 0.0;
  double upper_v = 0.0;
  double lower_v = 0.0;
  double offset_v = 0.0;
};

/// -gain (1 + s/z)/(1 + s/p) by R1 || C1 into R2 || C2 around an op-amp. The capacitors' mismatches are parts
/// of their value.
struct SectionParts {
  double gain = 1.0;
  double zero_hz = 0.0;
  double pole_hz = 0.0;
  double input_mismatch = 0.0;
  double feedback_mismatch = 0.0;
};
TwoPort section_port(SectionParts parts, OpAmp opamp);
/// -gain by two resistors around an op-amp.
TwoPort inverter_port(double gain, OpAmp opamp);
/// A voltage follower.
TwoPort follower_port(OpAmp opamp);
/// R and C behind a buffer.
TwoPort lowpass_port(double corner_hz);
/// Series L and R, C to ground.
TwoPort rlc_port(double hz, double damping);
/// A lossless matched line.
TwoPort line_port(double delay_s);
/// Two diodes with a source each let through what exceeds the half width.
TwoPort dead_zone_port(double width_v);
/// A capacitor charged over the same pair of diodes: it follows with a play of the width.
TwoPort play_port(double width_v);
/// Several of these beside the direct way, weighted and added.
TwoPort plays_port(std::vector<double> widths_v, std::vector<double> weights);
/// A switch, closed for a 200th of the clock's period, and a capacitor.
TwoPort hold_port(double clock_hz);
/// The direct way and weighted low-passes: dielectric absorption.
TwoPort absorption_port(std::vector<double> gains, std::vector<double> time_constants_s);
/// A sine in series.
TwoPort hum_port(double amplitude_v, double hz, double phase_deg);
/// A constant voltage in series.
TwoPort series_port(double offset_v);
/// A constant current into a capacitor, in series.
TwoPort drift_port(double rate_v_per_s);
/// A peak holder: a diode into R || C.
TwoPort diode_port(double load_s, double drop_v);

/// W = X Y/U + Z with offsets of its inputs, scale error and output offset.
struct Multiplier {
  double scale = 1.0;
  double x_offset_v = 0.0;
  double output_offset_v = 0.0;
};
/// u + c2 u^2 + c3 u^3 by two multipliers.
TwoPort curve_port(double c2, double c3, Multiplier multiplier);
/// u + a1 u + a2 u^2 + a3 u^3 with the coefficients picked by a switch (node `branch`, 1 V: ascending) whose
/// line has a time constant.
TwoPort branches_port(std::vector<double> up, std::vector<double> down, Multiplier multiplier, double line_s);
/// y'' + 2 d w y' + w^2 (y + q y^2 + c y^3) + drag w |y'| y' = g w^2 u by two integrators and multipliers.
struct SpringParts {
  double gain = 1.0, hz = 0.0, damping = 0.0, quadratic = 0.0, cubic = 0.0, drag = 0.0;
};
TwoPort spring_port(SpringParts parts);

/// Output of the two-ports in series at the samples of u. `with_branch` drives the node `branch`
/// with steep edges. `resonant`: integrated without numerical damping. Throws InputError when ngspice fails.
std::vector<double> run_deck(const std::vector<TwoPort>& ports, const std::vector<double>& u, double step_s,
                             bool with_branch, bool resonant);

}  // namespace hidden
