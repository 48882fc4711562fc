#pragma once

#include <complex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace bodesmith::circuit {

/// The four canonical forms of an RC impedance (Guillemin, Synthesis of Passive Networks, 1957):
///   Foster I   series chain of R||C (partial fractions of Z)
///   Foster II  parallel branches of R + C (partial fractions of Z^-1/s)
///   Cauer I    ladder of series R, shunt C (continued fraction about infinity)
///   Cauer II   ladder of shunt R, series C (continued fraction about zero)
enum class LadderForm { foster1, foster2, cauer1, cauer2 };

/// "foster1" … "cauer2".
std::optional<LadderForm> ladder_form_named(std::string_view name);

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

/// The parts, 2 n + 1 of them. A value that is not above 0 means poles and zeros that do not alternate, or a
/// continued fraction that the arithmetic (long double) does not carry: the caller decides.
std::vector<LadderPart> ladder_parts(const RcImpedance& z, LadderForm form);

/// Z(s) of parts with these values, in the order of ladder_parts().
std::complex<double> ladder_impedance(LadderForm form, std::span<const double> values,
                                      std::complex<double> s);
/// Poles, zeros and Z(infinity) of parts with these values: natural frequencies with open and with shorted
/// terminals, from the symmetric pencil of the capacitors' voltages (Cauer II: of the loop currents).
RcImpedance impedance_of(LadderForm form, std::span<const double> values);

}  // namespace bodesmith::circuit
