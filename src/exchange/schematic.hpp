#pragma once

#include <string>
#include <vector>

#include "lti/frequency_grid.hpp"

namespace bodesmith::exchange {

/// A circuit of resistors, capacitors and op-amps between named nodes, "0" being ground, driven at node "in".
struct Schematic {
  struct TwoPole {
    bool capacitor = false;  ///< else a resistor
    std::string name;        ///< begins with R or C
    std::string from;
    std::string to;
    double value = 0.0;  ///< ohm or farad
    std::size_t stage = 0;
  };
  struct OpAmp {
    std::string name;
    std::string plus;
    std::string minus;
    std::string out;
    std::size_t stage = 0;
  };
  std::vector<TwoPole> parts;
  std::vector<OpAmp> opamps;
  double open_loop_gain = 1e5;  ///< of every op-amp
  double gain_bandwidth_hz = 1e7;
  Band band;  ///< to be looked at
};

}  // namespace bodesmith::exchange
