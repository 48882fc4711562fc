#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/documents/document.hpp"
#include "base/documents/json_fwd.hpp"
#include "base/error.hpp"
#include "base/provenance.hpp"
#include "base/units.hpp"
#include "fpaa/cams/placed_cam.hpp"
#include "fpaa/device/board.hpp"
#include "fpaa/device/clock_tree.hpp"
#include "fpaa/device/mismatch.hpp"
#include "lti/frequency_grid.hpp"
#include "lti/sections.hpp"

namespace bodesmith::fpaa {

struct ChipPlan {
  int chip = 1;
  Hertz master_clock;
  ClockPlan clocks;
  std::vector<PlacedCam> cams;  ///< in signal order
  /// I/O cells of the pins ("in1" -> "IO1"), once a stream has been made.
  std::map<std::string, std::string> pins = {};
  Resources resources() const;
};

/// A CAM in its place on a board, and what it reads.
struct WiredCam : PlacedCam {
  int chip = 1;
  std::vector<std::string> inputs;  ///< names of CAMs, or of signals from outside
};

/// One connection of a plan. Its ends are pins ("chip1.in1", "chip1.out1") and CAMs ("chip1.Section1a").
struct Wire {
  std::string from;
  std::string to;
  int input = 1;  ///< which input of `to`, counted from 1
};

/// An end of a wire: a CAM, or a pin ("in1", "out2") of a chip.
struct WireEnd {
  int chip = 0;  ///< 0: none is named
  std::string name;

  explicit WireEnd(const std::string& text);
  bool is_input_pin() const { return is_numbered("in"); }
  bool is_output_pin() const { return is_numbered("out"); }

 private:
  bool is_numbered(std::string_view kind) const;
};

/// Differences between plan and sections over a band.
struct PlanError : ResponseDifference {
  Band band;

  Json to_json() const;
};

/// Frequencies of the band at which a response is held against what was asked for.
inline constexpr int kStatedPoints = 801;

/// What 95 % of boards keep of a sine of `at_input_v` at the pin (the largest that clips no node), and its parts, in
/// percent of the response that was asked for (noise: of the sine at the output). Random parts add by squares.
struct PlanTotal {
  double p95_percent = 0.0;
  double at_input_v = 0.0;
  double designed_percent = 0.0;
  double mismatch_p95_percent = 0.0;
  double noise_percent = 0.0;   ///< rms in the band over the rms of the sine where it comes out largest
  double offset_percent = 0.0;  ///< 0: not known
  double from_bound_db = 0.0;   ///< at_input_v against what input and output pin alone would let in
  /// Lines k fc +- f that lie in the band, all of a sine together: rms over sines spread evenly over the band's decades, of the
  /// response asked for at the sine. Other frequencies than the sine's own, therefore next to p95_percent, not in it.
  double image_percent = 0.0;
};

/// A design that the search found and that no other one found beats in all three: error by design, of 95 % of boards, and input.
struct TradeOff {
  double at_input_v = 0.0;
  double designed_percent = 0.0;
  double p95_percent = 0.0;
  int opamps = 0;
  bool chosen = false;
};

/// What a board shows at the pin besides what was asked for, as a share of that, above which it is of no use: a quarter, 12 dB below.
/// As an error of the response the design is refused, as images in the band it is said.
inline constexpr double kUselessShare = 0.25;

/// A line that the switches add to a sine.
struct ImageLine {
  Hertz signal;  ///< the sine that has it
  Hertz line;
  double magnitude_db = 0.0;  ///< against the signal at the output
};

/// Sections as switched-capacitor CAMs on the chips of a board (bodesmith.fpaa_plan/1).
struct Plan {
  std::string board;
  std::vector<ChipPlan> chips;
  std::vector<Wire> wires;         ///< every connection
  PlanError error;                 ///< all wires, gains included, by the z-transfers alone
  PlanError error_with_delays;     ///< the board as its switches make it
  std::optional<PlanTotal> total;  ///< what 95 % of boards keep
  MismatchModel mismatch;          ///< assumed of the boards that `total` speaks of; who draws others says so
  SlowParts slow;                  ///< assumed of every CAM, in every figure as it runs
  /// By rising input, where the plan misses .5 % designed, 1.5 % for 95 % of boards, or an input of 1 V (two thirds of what
  /// the largest gain allows, where that is less); empty: it has all three.
  std::vector<TradeOff> trade_off;
  double max_input_v = 0.0;  ///< input (sine of any frequency, or step) at which a node reaches full scale
  double max_step_v = 0.0;   ///< the same for a step alone
  std::optional<ImageLine> image;          ///< the largest line below 100 kHz that is not the signal
  std::optional<ImageLine> image_in_band;  ///< the largest that lies within the band
  std::string topology;                    ///< "chain" (of the vendor's CAMs), "cascade" (own stages in it)
  std::vector<std::string> assumptions;    ///< what is not publicly known and was assumed
  std::vector<std::string> notes;          ///< decisions a person should know

  std::vector<const PlacedCam*> cams() const;
  std::set<double> clocks_hz() const;
  int opamps() const;
  /// The first input pin that nothing leads to ("chip1.in1"), the first output pin that nothing starts from; empty: there is none.
  std::string input_pin() const;
  std::string output_pin() const;
  /// Every pin and CAM of the shortest way between them: "chip1.in1", "chip1.Section1a", ..., "chipN.outM".
  std::vector<std::string> signal_path() const;

  static Plan from_node(const Node& node);
  static Plan read(const std::filesystem::path& path, Provenance& from);
  /// Without the header.
  Json to_json() const;
};

struct PlanOptions {
  enum class Topology {
    automatic,  ///< the vendor's CAMs where they do as well, else this program's own stages too
    chain,      ///< CAMs that AnadigmDesigner2 has, alone
    bilinear,   ///< FilterBilinear alone, on one chip at one clock: the disturbance paper's configuration
  };
  std::string board = "an231k04-quad4";
  Topology topology = Topology::automatic;
  BoardAssumptions assumptions;  ///< mismatch, noise, op-amps: what is not publicly known
  std::optional<Hertz> clock;    ///< one clock for all, and the vendor's CAMs alone; absent: searched
  /// No clock below this (none below 31.4 kHz needs no system divisor): slow poles by two ratios.
  std::optional<Hertz> lowest_clock;
  bool quick =
      false;  ///< for a comparison: the best chains as they come, made whole once, in a tenth of the time
  std::optional<Band> band;  ///< where errors are minimised and stated; absent: the corners (and the band
                             ///< that sections.json states), widened to a tenth of the lowest corner
};

/// "auto", "chain", "bilinear".
const char* to_string(PlanOptions::Topology topology);

/// Everything a plan says of itself (errors, headroom, images, total, assumptions), by the switched-network solver.
void state_figures(Plan& plan, const Sections& sections, Band band, const BoardAssumptions& assumptions);

/// Refused when the sections cannot be made of the board's CAMs, with what would make them fit.
Outcome<Plan> make_plan(const Sections& sections, const PlanOptions& options);

}  // namespace bodesmith::fpaa
