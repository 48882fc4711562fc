#pragma once

#include <complex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace bodesmith::synthesis {

/// Z(s) = high prod (s + z_k)/(s + p_k), p_1 < z_1 < p_2 < … (rad/s): resistive at both ends, an RC
/// impedance.
struct RcImpedance {
  std::vector<double> poles, zeros;  ///< rising, as many of each
  double high = 1.0;                 ///< Z(infinity), ohm

  std::complex<double> operator()(std::complex<double> s) const;
};

struct LadderPart {
  bool resistor = true;
  std::string name, from, to;  ///< nodes: "a" and "b" are the terminals, others n1, n2, …
  double value = 0.0;
};

/// A canonical form of an RC impedance of n poles (Guillemin, Synthesis of Passive Networks, 1957): 2 n + 1
/// parts, which stand in `values` in the order of parts().
class RcLadder {
 public:
  virtual ~RcLadder() = default;
  virtual std::string_view name() const = 0;
  /// A value that is not above 0 means poles and zeros that do not alternate, or a continued fraction that
  /// the arithmetic (long double) does not carry: the caller decides.
  virtual std::vector<LadderPart> parts(const RcImpedance& z) const = 0;
  /// Z(s) of parts with these values.
  virtual std::complex<double> impedance(std::span<const double> values, std::complex<double> s) const = 0;
};

/// Poles, zeros and Z(infinity) of any resistors and capacitors between "a" and "b": natural frequencies with open and with shorted
/// terminals, x Zc i = i/C of the capacitors' currents i, Zc the resistors' impedance matrix at the capacitors.
RcImpedance impedance_of(const std::vector<LadderPart>& parts);

/// Series chain of R||C (partial fractions of Z).
const RcLadder& foster1();
/// Parallel branches of R + C (partial fractions of Y/s).
const RcLadder& foster2();
/// Ladder of series R, shunt C (continued fraction about infinity).
const RcLadder& cauer1();
/// Ladder of shunt R, series C (continued fraction about zero).
const RcLadder& cauer2();

}  // namespace bodesmith::synthesis
