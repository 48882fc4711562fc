#pragma once

#include <cstddef>
#include <vector>

#include "fpaa/search/design.hpp"
#include "lti/sections.hpp"

namespace bodesmith::fpaa {

/// The roots of one stage of a chain, or of a stage and the sum behind it.
struct StageRoots {
  std::vector<Complex> poles;  ///< rad/s; none: a gain
  std::vector<Complex> zeros;
  bool second = false;    ///< two op-amps
  bool subtract = false;  ///< a sum behind it takes it from its own input: zeros in the right half plane

  double corner() const;  ///< geometric mean of |poles|, rad/s
  /// ln of pole over zero, without sign; infinite where it is not one of each.
  double width() const;
  /// |response| at jw but for a factor.
  double magnitude(RadPerSecond w) const;
  /// The highest clock at which two capacitors reach its corners with one ratio, or the two ratios of a second-order stage.
  double highest_clock_hz() const;
};

struct SharingOptions {
  double lowest_clock_hz =
      0.0;  ///< corners that one ratio does not reach from there take a second-order stage with its two
  double low_zero = 0.0;       ///< rad/s: real zeros below are put at 0
  double far_zero = 0.0;       ///< rad/s: real zeros beyond are left out
  bool nearest_zeros = false;  ///< zeros to the nearest poles, else the lowest to the lowest
  std::size_t left_out =
      0;  ///< so many of the closest pole-zero pairs are left out: the others make up for them
  /// So often the lowest first-order stage and the highest become one of second order: a corner far below its clock is two
  /// capacitor ratios then, of ten units and more, where it was one of a unit or two, whose mismatch is the gain at rest.
  std::size_t joined = 0;
};

/// Shares the roots of all sections out over stages; empty when some zero finds no place.
std::vector<StageRoots> shared_roots(const Sections& sections, const SharingOptions& options);

/// A stage that only inverts, with so many others before it.
DesignStage gain_stage(std::size_t before);

/// Capacitors (not whole, about 200 units the largest) that put these roots where z = exp(sT) does, T the period of `clock_hz`.
/// One stage, or two where the roots are subtracted; inputs are kBoardInput, for the second stage the first (0) and then
/// kBoardInput. Empty when a capacitor would have to be negative.
std::vector<DesignStage> initial_stages(const StageRoots& roots, double clock_hz);

}  // namespace bodesmith::fpaa
