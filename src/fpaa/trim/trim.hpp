#pragma once

#include <optional>
#include <vector>

#include "base/documents/json_fwd.hpp"
#include "fpaa/device/mismatch.hpp"
#include "fpaa/plan/drawn_board.hpp"
#include "fpaa/plan/plan.hpp"
#include "lti/sections.hpp"

namespace bodesmith::fpaa {

/// A response measured on the built board, at rising frequencies, as it runs (holds inside).
struct MeasuredBoard {
  std::vector<Hertz> grid;
  std::vector<double> gain;       ///< linear magnitude
  std::vector<double> phase_rad;  ///< empty: magnitude only
  /// Standard deviation of the magnitude relative to itself and of the phase in rad; absent: the value under
  /// which the measurement is most likely.
  std::optional<double> deviation;
};

/// What a measurement says about the capacitors. Prior: the mismatch model. With x the relative errors of the
/// capacitors and S = d ln H/d ln C, the measured ln H differs from the plan's by S x + noise (linear; taken
/// again at the estimate), so x is normal with
///   covariance P = (W + S' S/s^2)^-1, mean P S' y/s^2, W the inverse of the prior's variances
/// (regularised least squares; Gelman et al., Bayesian Data Analysis, 2013, section 14.8). s, where the
/// measurement does not say it, maximises the density of y.
struct BoardEstimate {
  std::vector<double> error;              ///< x of each capacitor of DrawnBoard
  std::vector<std::vector<double>> root;  ///< square root of P: x + root * (standard normal numbers)
  double noise = 0.0;                     ///< s
};
/// Throws DesignError where the measurement has nothing to do with the plan (more than a factor of 2 away).
BoardEstimate estimate_board(const Plan& plan, const MeasuredBoard& measured, const MismatchModel& mismatch);

/// Worst complex error over the band, percent; median and 95 % of what the estimate leaves open.
struct TrimError {
  double median_percent = 0.0;
  double p95_percent = 0.0;
};

struct TrimmedCapacitor {
  std::string name;
  int before = 0;
  int after = 0;
};

struct TrimOptions {
  MismatchModel mismatch;
  UnitArray array = UnitArray::binary;  ///< an ASSUMPTION: the one of the two that exchanges more units
  int samples = 400;  ///< of boards that agree with the measurement, by which a change must prove itself
  std::uint64_t seed = 1;
  std::optional<Band> band;  ///< absent: the plan's
};

struct Trim {
  Plan plan;  ///< with the new capacitors; the old ones where better is not certain
  bool improved = false;
  std::vector<TrimmedCapacitor> changes;
  TrimError before;
  TrimError after;
  UnitArray array = UnitArray::binary;
  BoardEstimate estimate;

  Json to_json() const;
};

/// New whole capacitors for a board that was measured, so that it comes to `wanted` (as it runs) over the
/// plan's band. What a capacitor keeps of its error when its units change: exchanged_units(). The old
/// capacitors are kept unless the new ones are better on every one of `samples` boards drawn from what the
/// measurement and the exchanged units leave open. Measured and trimmed again, a board starts from the model
/// anew, with the capacitors of the first trim as the plan.
Trim trim_board(const Plan& plan, const std::vector<Complex>& wanted, const std::vector<Hertz>& grid,
                const MeasuredBoard& measured, const TrimOptions& options);

/// The grid on which a trim judges, and the plan's own response there: the target when there are no sections.
std::vector<Hertz> trim_grid(const Plan& plan, const TrimOptions& options);

/// A plan with these capacitors (in the order of DrawnBoard): their z-domain coefficients with them.
Plan with_capacitors(const Plan& plan, const std::vector<int>& units);

}  // namespace bodesmith::fpaa
