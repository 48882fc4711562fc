#pragma once

#include <complex>
#include <vector>

#include "lti/state_space.hpp"

namespace bodesmith::simulate {

/// A stable linear system H(s) = d + sum_k r_k/(s - p_k), pole by pole (a conjugate pair counts as one
/// complex mode).
struct ModalSystem {
  double direct = 0.0;
  std::vector<std::complex<double>> poles;  ///< one of each pair, imaginary part >= 0
  std::vector<std::complex<double>> residues;
  /// sum |r_k/p_k| over the largest |H| seen at its own corners: how many times larger the modes are than
  /// what they add up to. Rounding is that much worse; near-equal poles make it large.
  double condition = 1.0;

  /// Products over the roots, cost n^2. Poles that are exactly equal give an infinite condition.
  static ModalSystem from(const Sections& sections);
  /// Eigenvalues of a state space (its offset and constant are left to the caller).
  static ModalSystem from(const StateSpace& system);
  /// Sets `condition` from the rest.
  void find_condition();
  /// Above it an engine should not use the modes.
  static constexpr double kMaxCondition = 1e6;
};

}  // namespace bodesmith::simulate
