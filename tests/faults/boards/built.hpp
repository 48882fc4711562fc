#pragma once

#include <complex>
#include <string>
#include <vector>

#include "faults/measurement.hpp"
#include "numeric/random.hpp"
#include "synthesis/circuit.hpp"

namespace bodesmith::faults {

/// A board as somebody soldered it: every part with a value of its own, every op-amp with a gain-bandwidth of its own,
/// and what was done wrong. Written as a netlist by other code than the program's and measured by ngspice.
struct BuiltBoard {
  synthesis::Circuit circuit;  ///< `realised` is what is mounted
  std::vector<double> gain_bandwidth_hz;
  std::vector<char> open;  ///< of each part
  std::vector<char> shorted;
  std::vector<char> floating_plus;  ///< of each op-amp
  double stray_f = 1e-14;           ///< from a floating input to ground
  std::vector<std::string> more;    ///< further lines: loads
  /// What is wrong, as the program would name it; any one of each inner list is right.
  std::vector<std::vector<std::string>> wrong;
  std::string words;
};

/// Parts within their tolerance (uniform), op-amps within 25 %.
BuiltBoard good_board(const synthesis::Circuit& circuit, double resistor_percent, double capacitor_percent,
                      Random& random);

/// Adds one fault, drawn.
void spoil(BuiltBoard& board, Random& random);

/// V(out)/V(in) of the board as ngspice finds it; op-amps with input capacitances and a second pole at three times
/// their gain-bandwidth.
std::vector<std::complex<double>> response_of(const BuiltBoard& board, const std::vector<Hertz>& grid,
                                              const std::string& node = "out");

/// With noise.
Channel measured(const std::vector<std::complex<double>>& response, const std::vector<Hertz>& grid,
                 double noise_db, double noise_deg, bool with_phase, Random& random);

}  // namespace bodesmith::faults
