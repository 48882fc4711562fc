#pragma once

#include <complex>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/document.hpp"
#include "base/json_fwd.hpp"
#include "base/outcome.hpp"
#include "base/provenance.hpp"
#include "base/units.hpp"
#include "fpaa/board.hpp"
#include "fpaa/clock_tree.hpp"
#include "fpaa/placed_cam.hpp"
#include "lti/frequency_grid.hpp"
#include "lti/sections.hpp"

namespace bodesmith::fpaa {

struct ChipPlan {
  int chip = 1;
  Hertz master_clock;
  ClockPlan clocks;
  std::vector<PlacedCam> cams;  ///< in signal order
  Resources resources() const;
};

/// One connection of a plan. Its ends are pins ("chip1.in1", "chip1.out1") and CAMs ("chip1.Section1a").
struct Wire {
  std::string from;
  std::string to;
  int input = 1;  ///< which input of `to`, counted from 1
};

/// Differences between plan and sections over a band.
struct PlanError {
  Band band;
  double max_magnitude_db = 0.0;
  double max_phase_deg = 0.0;
  double max_complex_percent = 0.0;
  Hertz worst;
};

/// Sections as switched-capacitor CAMs on the chips of a board (bodesmith.fpaa_plan/1).
struct Plan {
  std::string board;
  std::vector<ChipPlan> chips;
  std::vector<Wire> wires;  ///< one path from an input pin to an output pin, in signal order
  PlanError error;          ///< product of all CAMs, gains included, without holds and delays
  PlanError error_with_delays;
  double max_input_v = 0.0;  ///< sine input at which the first node reaches full scale, any frequency
  std::vector<std::string> assumptions;  ///< what is not publicly known and was assumed
  std::vector<std::string> notes;        ///< decisions a person should know

  std::vector<const PlacedCam*> cams() const;
  /// Every pin and CAM along the wires: "chip1.in1", "chip1.Section1a", ..., "chipN.outM".
  std::vector<std::string> signal_path() const;

  static Plan from_node(const Node& node);
  static Plan read(const std::filesystem::path& path, Provenance& from);
  /// Without the header.
  Json to_json() const;
};

/// Product of all CAMs on jw: what the board does to a sine of frequency w at that same frequency.
/// `with_delays` includes every hold and half-cycle delay.
std::complex<double> plan_response(const Plan& plan, RadPerSecond w, bool with_delays);

struct PlanOptions {
  std::string board = "an231k04-quad4";
  std::optional<Hertz> clock;  ///< one clock for all; absent: the best of the legal tree
  std::optional<Band> band;    ///< where errors are minimised and stated; absent: the corners (and the band
                               ///< that sections.json states), widened to a tenth of the lowest corner
};

/// Refused when the sections cannot be made of the board's CAMs, with what would make them fit.
Outcome<Plan> make_plan(const Sections& sections, const PlanOptions& options);

}  // namespace bodesmith::fpaa
