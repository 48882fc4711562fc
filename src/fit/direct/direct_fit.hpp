#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/documents/json_fwd.hpp"
#include "base/progress.hpp"
#include "base/units.hpp"
#include "lti/sections.hpp"
#include "signal/bode_points.hpp"

namespace bodesmith {

/// Integer sections straight to target gains, stable and minimum-phase, without a fractional detour.
struct DirectFitOptions {
  int order = 4;               ///< poles, 1 to 12
  int relative_degree = 0;     ///< poles minus zeros
  bool real = false;           ///< real poles and zeros only (they fit bilinear blocks)
  bool least_squares = false;  ///< smallest rms dB; otherwise the largest weighted |dB| is made smallest
  bool use_phase = false;      ///< fit the points' phase too (complex data)
  /// No corner above this. Without it: 1000 times the highest point. A low cap keeps the gain above the band
  /// near the points' (the five points of the disturbance paper fitted without one rise by 18 dB).
  std::optional<Hertz> max_corner{};
  double min_damping = 0.05;  ///< of complex pairs
  /// Gain masks, in the points' own unit; interpolated linearly in dB over log frequency, active inside their
  /// range.
  std::optional<BodePoints> upper{};
  std::optional<BodePoints> lower{};
  std::uint64_t seed = 1;  ///< of the starts beyond the constructed ones
  int starts = 24;         ///< random starts of the highest order
  Deadline deadline{};     ///< what was not tried then stands in DirectFit::not_tried
};

struct DirectFitPoint {
  Hertz frequency;
  double wanted_db = 0.0;
  double got_db = 0.0;
};

struct DirectFit {
  Sections sections;  ///< error over the points' band filled in; phase error only with use_phase
  std::vector<DirectFitPoint> points;
  double max_db = 0.0;
  double rms_db = 0.0;
  double max_phase_deg = 0.0;      ///< with use_phase
  double mask_violation_db = 0.0;  ///< largest, 0 when the masks are kept or absent
  /// Relative to the largest point: what happens where nothing was asked.
  double highest_gain_above_band_db = 0.0;
  int parameters = 0;
  int starts_tried = 0;
  int cancelled = 0;        ///< poles of the order asked for that met a zero and were left out
  int distant_zeros = 0;    ///< zeros far above the points that made nothing better and were left out
  int zeros_at_origin = 0;  ///< zeros far below the points that stand at 0 Hz as well
  std::vector<std::string> warnings;
  std::vector<std::string> not_tried;  ///< when the deadline passed

  Json report_json() const;
};

/// ln|H| is fitted: with fewer points than parameters the smoothest-start solution is moved onto the points,
/// otherwise starts are built up order by order (the best fit so far plus a pole-zero pair at several
/// frequencies, and random ones), improved by Levenberg-Marquardt, and the best refined by sequential
/// quadratic (rms) or linear (Chebyshev) programming in a trust region. Throws InputError for an order out of
/// range or no points.
DirectFit fit_directly(const BodePoints& points, const DirectFitOptions& options);
/// Orders from `min_order` up to `max_order` until the largest error is within `limit_db`; the fit of the last order
/// when none is. `options.order` does not apply.
DirectFit fit_directly_within(const BodePoints& points, DirectFitOptions options, double limit_db,
                              int min_order, int max_order);

}  // namespace bodesmith
