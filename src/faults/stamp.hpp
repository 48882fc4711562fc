#pragma once

#include <array>
#include <complex>

namespace bodesmith::faults {

/// A change of one admittance, or of one op-amp's equation, in the nodal equations A x = b of a circuit:
///   A x + delta(s) u (v'x + constant) = b,   delta(s) = g + c s + d s^2.
/// u and v have two entries at most. An admittance y between nodes p and q: u = v = e_p - e_q, delta = y; where one
/// of them is the input (V = 1, known), it is the constant; ground is left out.
struct Stamp {
  struct Entry {
    int at = 0;
    double weight = 0.0;  ///< 0: not there
  };
  std::array<Entry, 2> into;   ///< u
  std::array<Entry, 2> reads;  ///< v
  double constant = 0.0;
  double g = 0.0;
  double c = 0.0;
  double d = 0.0;
  bool rough = false;  ///< known to within Effect::model_error of the change that it makes only

  std::complex<double> delta(std::complex<double> s) const { return g + s * (c + s * d); }
  Stamp times(double factor) const {
    Stamp out = *this;
    out.g *= factor;
    out.c *= factor;
    out.d *= factor;
    return out;
  }
};

}  // namespace bodesmith::faults
