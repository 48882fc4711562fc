#pragma once

#include <string>
#include <vector>

#include "base/documents/json_fwd.hpp"
#include "fpaa/device/mismatch.hpp"
#include "fpaa/network/settling.hpp"
#include "fpaa/plan/drawn_board.hpp"
#include "fpaa/plan/plan.hpp"
#include "lti/sections.hpp"

namespace bodesmith::fpaa {

/// The plan's error as it runs with op-amps and switches that follow late: those it knows, else what such chips may have.
struct LateFigure {
  SlowParts parts;
  double percent = 0.0;
  Hertz worst{0.0};
};
LateFigure late_figure(const Plan& plan, const Sections& sections);
/// A line on it where the plan knows none and it is more than ngspice on the board's netlist may differ from the stated error
/// (2 % of it, .02 points); where it knows them, unsettled_text(). Empty elsewhere.
std::string late_text(const Plan& plan, const LateFigure& late);
/// A sentence on the CAM that settles least where the parts that the plan knows leave more than .02 % of a step when a phase is over:
/// the figures take each phase as settled. Empty elsewhere.
std::string unsettled_text(const Plan& plan);

/// What departs from a plan as its switches make it, each cause by itself, over the plan's band.
struct ErrorBudget {
  /// Capacitors that matter most to what drawn boards do (plan_total), and the models that were assumed.
  std::vector<DrawnBoard::Share> capacitors;
  BoardAssumptions assumptions;

  struct CamShare {
    std::string name;
    double gain = 1.0;                 ///< the larger of DC and high-frequency gain
    double settling_product_hz = 0.0;  ///< (1 + gain) fc
    double peak_node_gain = 0.0;       ///< highest magnitude from the input to this CAM's output
    double noise_kt_per_cu =
        0.0;  ///< mean square at the plan's output up to half the fastest clock, in kT/C_u
    double noise_in_band_kt_per_cu = 0.0;
    double settling_percent = 0.0;  ///< of its largest step (settling.hpp)
  };
  std::vector<CamShare> cams;
  double settling_limit_hz = 0.0;
  double noise_kt_per_cu = 0.0;
  double noise_in_band_kt_per_cu = 0.0;

  /// Op-amps do not settle whole in half a period: at most the sum of what each CAM leaves of its step; and they follow late.
  LateFigure late;
  double settling_percent = 0.0;

  Json to_json() const;
};

/// Noise: what every switch leaves on its capacitor when it opens (kT C of mean-square charge), in every phase, as the
/// network makes it at the pin, every folding in it (network/periodic_network.hpp). C_u, the unit capacitance, is not
/// publicly known, so the result is in kT/C_u, and in uV for the assumed one. Op-amp noise is not in it (not publicly
/// known).
ErrorBudget error_budget(const Plan& plan, const Sections& sections, const BoardAssumptions& assumptions);

/// What 95 % of boards keep (contract: plan.json's "total"), from figures that the plan states and drawn boards, to the first
/// order in what each capacitor is off.
PlanTotal plan_total(const Plan& plan, const SwitchedBoard& switched, const Sections& sections,
                     const BoardAssumptions& assumptions);

}  // namespace bodesmith::fpaa
