#pragma once

#include <complex>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/document.hpp"
#include "base/json.hpp"
#include "base/provenance.hpp"
#include "base/units.hpp"
#include "fpaa/board.hpp"
#include "fpaa/clock_tree.hpp"
#include "fpaa/z_transfer.hpp"
#include "lti/frequency_grid.hpp"
#include "lti/sections.hpp"

namespace bodesmith::fpaa {

struct Capacitor {
  std::string name;
  int units = 0;
};

/// One CAM (configurable analog module) as it is placed and realised.
struct PlacedCam {
  std::string name;     ///< unique on its chip, e.g. "Section2a"
  std::string cam;      ///< "FilterBilinear", "GainInv", ...
  std::string option;   ///< "Pole and Zero", ...
  int cab = 1;          ///< 1-4
  int clock_index = 0;  ///< Clock 0-3 of its chip
  Hertz clock_a;
  int phase = 1;               ///< output phase
  std::optional<int> section;  ///< index into sections.json, from 0
  Json requested;              ///< parameter -> value, keys end in their unit
  Json realised;
  std::vector<Capacitor> capacitors;
  ZTransfer z;                              ///< exactly what the capacitors make, at clock_a
  double delay_cycles = 0.0;                ///< from input sample to output, beyond z
  std::optional<double> own_error_percent;  ///< of these capacitors alone, gain free, over the plan's band
  std::optional<double> least_own_error_percent;  ///< proven: no capacitors at this clock do better alone
  bool output_hold = false;  ///< its held output leaves this clock's domain: one zero-order hold
  Resources resources;

  /// z, and with_delays also the delay and the hold.
  std::complex<double> response(RadPerSecond w, bool with_delays) const;
};

struct ChipPlan {
  int chip = 1;
  Hertz master_clock;
  ClockPlan clocks;
  std::vector<PlacedCam> cams;  ///< in signal order
  Resources resources() const;
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
  std::vector<std::string> signal_path;  ///< "chip1.in1", "chip1.Section1a", ..., "chipN.outM"
  PlanError error;                       ///< product of all CAMs, gains included, without holds and delays
  PlanError error_with_delays;
  double largest_input_v = 0.0;  ///< sine input at which the first node reaches full scale, any frequency
  std::vector<std::string> assumptions;  ///< what is not publicly known and was assumed
  std::vector<std::string> notes;        ///< decisions a person should know

  std::vector<const PlacedCam*> cams() const;

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

/// Throws DesignError when the sections cannot be made of the board's CAMs, saying what would make them fit.
Plan make_plan(const Sections& sections, const PlanOptions& options);

}  // namespace bodesmith::fpaa
