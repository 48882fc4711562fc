#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/json_fwd.hpp"
#include "fpaa/plan.hpp"
#include "lti/sections.hpp"

namespace bodesmith::fpaa {

/// Where a plan's response departs from its sections, each cause by itself, over the plan's band.
struct ErrorBudget {
  /// Corners placed exactly by tan(pi f/fc) with unquantised capacitors, gain exact: what sampling alone
  /// costs.
  double warping_percent = 0.0;
  /// The plan's capacitors against those unquantised ones.
  double quantisation_percent = 0.0;
  /// Both together: the plan's `error` (they partly cancel: the search uses one against the other).
  double together_percent = 0.0;
  /// Holds and delays alone.
  double hold_percent = 0.0;
  double hold_phase_deg = 0.0;

  /// Capacitors off at random, each by sigma/sqrt 2 (normal), so that a ratio is off by sigma. `extra`: worst
  /// complex difference to the unperturbed plan over the band.
  struct Mismatch {
    double sigma_percent = 0.1;
    int draws = 0;
    std::uint64_t seed = 1;
    double median_percent = 0.0;
    double p95_percent = 0.0;
    double max_percent = 0.0;
  } mismatch;

  /// The held output also has images at k fc +- f. Magnitude of the nearest, fc - f, relative to the signal,
  /// for f at the top of the band: f/(fc - f).
  double image_db = 0.0;
  Hertz image;

  struct CamShare {
    std::string name;
    double gain = 1.0;                 ///< the larger of DC and high-frequency gain
    double settling_product_hz = 0.0;  ///< (1 + gain) fc
    double peak_node_gain = 0.0;       ///< highest magnitude from the input to this CAM's output
    double noise_kt_per_cu = 0.0;  ///< mean square at the plan's output, all frequencies to fc/2, in kT/C_u
    double noise_in_band_kt_per_cu = 0.0;
  };
  std::vector<CamShare> cams;
  double settling_limit_hz = 0.0;
  double noise_kt_per_cu = 0.0;
  double noise_in_band_kt_per_cu = 0.0;

  Json to_json() const;
};

struct BudgetOptions {
  double mismatch_sigma_percent = 0.1;
  int draws = 400;
  std::uint64_t seed = 1;
};

/// Noise: every switched capacitor C brings 2 kT C of mean-square charge a sample, which its op-amp's
/// feedback turns into the CAM's output and the rest of the chain filters; C_u, the unit capacitance, is not
/// publicly known, so the result is in kT/C_u. Op-amp noise is not in it (not publicly known).
ErrorBudget error_budget(const Plan& plan, const Sections& sections, const BudgetOptions& options);

}  // namespace bodesmith::fpaa
