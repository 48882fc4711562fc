#pragma once

#include <string>
#include <vector>

namespace bodesmith::controller {

/// A part with two ends. Node "0" is ground; `from` is a diode's anode.
struct Part {
  enum class Kind { resistor, capacitor, diode };
  Kind kind = Kind::resistor;
  std::string name;
  std::string role;     ///< for people: "weight of v^2, descending"
  std::string section;  ///< of the drawing: "powers", "rate"
  std::string from, to;
  std::string series;  ///< "E96", "E12"; a diode's type
  double wanted = 0.0;
  double realised = 0.0;
};

struct OpAmp {
  std::string name;
  std::string role;
  std::string section;
  std::string plus, minus, out;
  bool fast = false;  ///< of the slope detector's type
};

/// An AD835: W = X Y/U + Z.
struct Multiplier {
  std::string name;
  std::string role;
  std::string section;
  std::string x, y, z, out;
  double peak_v = 0.0;  ///< greatest |W|
};

/// One contact of the branch switch, closed while the reference rises, or while it falls.
struct Contact {
  std::string name;
  std::string section;
  std::string from, to;
  bool rising = true;
};

/// A reference voltage.
struct VoltageReference {
  std::string name;
  std::string type;  ///< what makes it
  std::string node;
  double volts = 0.0;
};

/// A voltage that enters a sum through a part; places in AnalogController's lists.
struct Term {
  std::string node;
  int part = -1;
  bool at_plus = false;
  double series_ohm = 0.0;  ///< in series with the part: a closed contact
};

/// One op-amp that sums with both signs: -Rf/Rk for terms at its inverting input, positive gains through the
/// conductances at the other; `balance` to ground at one of them.
struct Sum {
  int opamp = -1;
  std::vector<Term> terms;
  int feedback = -1;
  int balance = -1;
  bool balance_at_plus = true;
  int smoothing = -1;  ///< capacitor across the feedback
};

/// Precision rectifier, inverting: its node is -max(0, sum_k v_k Rf/Rk), or, `positive`, max(0, -sum).
struct Rectifier {
  int opamp = -1;
  std::vector<Term> terms;
  int feedback = -1;
  std::string node;
  bool positive = false;
  double corner_hz = 0.0;  ///< full-stroke triangle at which it begins to conduct; 0: none
};

}  // namespace bodesmith::controller
