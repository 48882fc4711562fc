#pragma once

#include <optional>
#include <string>

#include "fit/direct/direct_fit.hpp"
#include "lti/fractional_transfer.hpp"

namespace bodesmith::project {

/// How a fractional transfer function becomes integer sections: minimax in dB and degrees over a band, 40 points a decade.
struct FractionalFitOptions {
  Band band;
  std::optional<int> order;            ///< poles; none: the fewest within max_error_db, else that of `direct`
  std::optional<double> max_error_db;  ///< of the magnitude
  int max_order = 12;
  bool keep_integrator = false;  ///< an integrator s^-a stays one: round(a), at least 1, poles at 0
  DirectFitOptions direct{};     ///< real, seed, deadline, …; its order when nothing else says one
};

struct FractionalFit {
  DirectFit fit;  ///< the poles at 0 among its sections
  FractionalStability stability;
  int poles_at_zero = 0;

  /// Below it a finite gain takes the place of an integrator that was not kept.
  Hertz lowest_pole() const;
  bool within(std::optional<double> limit_db) const { return !limit_db || fit.max_db <= *limit_db; }
  /// The fit's report with `stability` and `poles_at_0`.
  Json report_json() const;
};

/// Throws DesignError that names `file` for a transfer function that is unstable or not minimum-phase, and for an
/// integrator that is to be kept and is not there.
FractionalFit fit_fractional(const FractionalTransfer& transfer, const std::string& file,
                             const FractionalFitOptions& options);

}  // namespace bodesmith::project
