#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/json_fwd.hpp"
#include "fpaa/charge_balance.hpp"
#include "fpaa/drawn_board.hpp"
#include "fpaa/mismatch.hpp"
#include "fpaa/plan.hpp"
#include "lti/sections.hpp"

namespace bodesmith::fpaa {

/// Where a plan's response departs from its sections, each cause by itself, over the plan's band.
struct ErrorBudget {
  /// Corners placed exactly by tan(pi f/fc) with unquantised capacitors, gain exact: what sampling alone
  /// costs. (Where every CAM says what was requested of it and they are one path: 0 otherwise.)
  double warping_percent = 0.0;
  /// The plan's capacitors against those unquantised ones.
  double quantisation_percent = 0.0;
  /// Both together: the plan's `error` (they partly cancel: the search uses one against the other).
  double together_percent = 0.0;
  /// Holds and delays alone.
  double hold_percent = 0.0;
  double hold_phase_deg = 0.0;

  /// Capacitors drawn by the mismatch model: worst complex difference to the plan as it is, as it runs.
  MismatchModel mismatch_model;
  std::uint64_t seed = 1;
  MismatchSpread mismatch;

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
    double settling_percent = 0.0;  ///< worst of its inputs over the band, each settled before its phase
  };
  std::vector<CamShare> cams;
  double settling_limit_hz = 0.0;
  double noise_kt_per_cu = 0.0;
  double noise_in_band_kt_per_cu = 0.0;
  NoiseModel noise_model;

  /// Op-amps with this bandwidth and gain do not settle whole in half a period: the plan's complex change over
  /// the band, by charge_balance.hpp, each CAM's inputs taken as settled.
  OpAmpModel opamp;
  double settling_percent = 0.0;

  Json to_json() const;
};

struct BudgetOptions {
  BoardAssumptions assumptions = {};
  OpAmpModel opamp = {};
  int draws = 400;
  std::uint64_t seed = 1;
};

/// The noise in the band alone: mean square at the output pin in kT/C_u.
double noise_in_band_kt_per_cu(const Plan& plan, Band band);

/// Noise: every switched capacitor C brings 2 kT C of mean-square charge a sample, which its op-amp's
/// feedback turns into the CAM's output and the rest of the chain filters; C_u, the unit capacitance, is not
/// publicly known, so the result is in kT/C_u, and in uV for the assumed one. Op-amp noise is not in it (not
/// publicly known). Between clocks: a slower CAM's noise is read as its held output; a faster one's folds, all
/// of it, into the reader's band.
ErrorBudget error_budget(const Plan& plan, const Sections& sections, const BudgetOptions& options);

}  // namespace bodesmith::fpaa
