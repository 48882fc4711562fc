#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/json_fwd.hpp"
#include "fpaa/plan.hpp"
#include "signal/disturbance.hpp"

namespace bodesmith::fpaa {

/// How the branch polynomials d(x) = a1 x + a2 x^2 + a3 x^3 are made.
enum class PolynomialBy {
  outside,      ///< AD835 multipliers beside the board give x^2 and x^3; weights on the board
  multipliers,  ///< Multiplier CAMs (one input through 8 bits); weights on the board
  lookup,       ///< a TransferFunction CAM a branch (256 bytes; one table a chip)
};
const char* to_string(PolynomialBy by);

struct ControllerOptions {
  std::string board = "an231k04-quad4";
  std::optional<PolynomialBy> polynomial;  ///< absent: the most accurate that fits
  Hertz fast_clock{250e3};                 ///< ClockA of everything but the compensators
  double outside_error_percent = 0.1;  ///< of each AD835 after trimming, of its full scale (to be measured)
};

/// One CAM of the controller, placed.
struct ControllerCam {
  std::string name;
  const Cam* cam = nullptr;  ///< an entry of cam_registry()
  std::string option;
  std::vector<std::string> inputs;  ///< names of CAMs, or of signals from outside ("x", "r", "slope", …)
  CamValues parameters;
  Hertz clock_a;
  double delay_cycles = 0.0;
  bool half_cycle = false;  ///< output valid during one phase only
  int phase = 1;
  Resources resources;
  int chip = 1;
  int cab = 1;
};

/// A way to make the polynomials, worked out as a whole controller.
struct ControllerVariant {
  PolynomialBy by = PolynomialBy::outside;
  std::optional<Refusal> refusal;  ///< what does not fit on the board
  double max_error_percent = 0.0;  ///< of d over x in [0, 1], both branches, in percent of the stroke
  double rms_error_percent = 0.0;
  double delay_s = 0.0;       ///< longest path from x to the output, compensator's hold included
  double bandwidth_hz = 0.0;  ///< of the polynomial: where its own delay is a tenth of a period, or 250 MHz
  int outside_multipliers = 0;
  std::vector<ControllerCam> cams;
  int chips = 0;
  std::vector<int> io_cells;  ///< used, of each chip
  Resources resources;

  bool fits() const { return !refusal; }
};

struct Controller {
  std::vector<ControllerVariant> variants;
  std::size_t chosen = 0;
  std::string why;
  std::vector<std::string> assumptions;
  const ControllerVariant& best() const { return variants[chosen]; }
  Json to_json() const;
};

/// The whole controller of the disturbance paper, Fig. 2 and section V-A: u = r - d(x), the branch by the slope's
/// sign, an amplitude gain and (where a branch changes with the rate) a compensator for each branch.
/// `ascending` and `descending` are finished plans of the compensators, or null for a static branch. Refused
/// when no way (or not the one asked for) fits the board, saying what would make it fit.
Outcome<Controller> make_controller(const Disturbance& disturbance, const Plan* ascending,
                                    const Plan* descending, const ControllerOptions& options);

std::string controller_sheet(const Controller& controller);

}  // namespace bodesmith::fpaa
