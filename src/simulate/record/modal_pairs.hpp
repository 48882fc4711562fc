#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "lti/state_space.hpp"

namespace bodesmith::simulate {

/// A stable linear system H(s) = d + sum_k r_k/(s - p_k), pole by pole (a conjugate pair counts as one
/// complex mode).
struct ModalSystem {
  double direct = 0.0;
  std::vector<Complex> poles;  ///< one of each pair, imaginary part >= 0
  std::vector<Complex> residues;
  /// sum |r_k/p_k| over the largest |H| seen at its own corners: how many times larger the modes are than
  /// what they add up to. Rounding is that much worse; near-equal poles make it large.
  double condition = 1.0;

  /// Eigenvalues of a state space (its offset and constant are left to the caller). Poles that are equal or nearly so give a large
  /// condition.
  static ModalSystem from(const StateSpace& system);
  /// Sets `condition` from the rest.
  void find_condition();
  /// Above it an engine should not use the modes.
  static constexpr double kMaxCondition = 1e6;
};

/// A state space in its modes, two by two: w = T x obeys
///   w' = Λ w + b u + constant,   y = c w + d u + offset,
/// where Λ is made of blocks of two states: two real modes (diagonal) or a conjugate pair [σ -ω; ω σ]. An odd
/// real mode has a partner that nothing drives and nobody reads.
struct ModalPairs {
  std::vector<double> blocks;  ///< 4 a pair, row by row
  std::vector<double> b;       ///< 2 a pair, as c and constant
  std::vector<double> c;
  std::vector<double> constant;   ///< empty: zero
  std::vector<double> transform;  ///< T, a row each state w, of as many columns as x has states
  bool coupled = false;           ///< there is a conjugate pair
  /// How many times larger the modes are than what they add up to (ModalSystem::condition): rounding is that much
  /// worse than the system's own.
  double condition = 1.0;
  double slowest_rad_s = 0.0;  ///< smallest -Re of a mode

  std::size_t pairs() const { return b.size() / 2; }
  /// w of the states x.
  void to_modes(const double* x, double* w) const;
};

/// Nothing where the modes would lose more than four digits: poles equal or nearly so.
std::optional<ModalPairs> modal_pairs(const StateSpace& system);

}  // namespace bodesmith::simulate
