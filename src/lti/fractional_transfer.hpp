#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "base/documents/document.hpp"
#include "base/provenance.hpp"
#include "base/units.hpp"

namespace bodesmith {

/// coefficient * s^power; s^power is the principal one, cut along the negative real axis.
struct FractionalPower {
  double coefficient = 1.0;
  double power = 0.0;
};

/// sum_k a_k s^alpha_k.
using FractionalPolynomial = std::vector<FractionalPower>;

/// Its value at s = jw.
Complex evaluate(const FractionalPolynomial& polynomial, RadPerSecond w);

/// Equal powers joined, zeros dropped, powers rising.
FractionalPolynomial collect_powers(FractionalPolynomial polynomial);

/// G(s) = (sum_i b_i s^beta_i) / (sum_k a_k s^alpha_k), powers >= 0 and of any size: a fractional PID
///   Kp + Ki s^-lambda + Kd s^mu = (Kp s^lambda + Ki + Kd s^(lambda + mu)) / s^lambda,
/// a constant-phase element s^-alpha, the tool-servo paper's eq. 15.
struct FractionalTransfer {
  FractionalPolynomial numerator;
  FractionalPolynomial denominator;

  Complex response(RadPerSecond w) const;

  /// TOML (or JSON) `bodesmith.fractional/1`:
  ///   numerator = [{coefficient = 2.0, power = 0.5}, ...], denominator = [...];
  /// or a controller: pid = {kp = 1, ki = 2, lambda = 0.8, kd = 0.1, mu = 0.6} (missing gains are 0).
  static FractionalTransfer from_node(const Node& node);
  static FractionalTransfer read(const std::filesystem::path& path, Provenance& from);
};

/// Where the zeros of D(s) = sum a_k s^alpha_k lie, on the principal sheet.
struct FractionalStability {
  /// Zeros with Re s > 0, by the argument principle, after the lowest power is factored out:
  ///   (alpha_max pi/2 - total turn of D(jw), w = 0 to infinity)/pi.
  int unstable_poles = 0;
  /// The same number by Matignon's theorem, where the powers have a common step q (to a denominator of 60):
  /// roots sigma of the polynomial in sigma = s^q with |arg sigma| < q pi/2.
  std::optional<int> matignon_count;
  double common_step = 0.0;  ///< q; 0 when there is none
  double powers_of_s = 0.0;  ///< the lowest power factored out: an integrator s^-powers_of_s in G
  /// Smallest |D(jw)| over the sum of its terms' sizes: 0 is a pole on the axis.
  double nearest_to_axis = 0.0;
  bool stable() const { return unstable_poles == 0; }
};
FractionalStability fractional_stability(const FractionalPolynomial& denominator);

}  // namespace bodesmith
