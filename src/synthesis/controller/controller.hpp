#pragma once

#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schematic/netlist.hpp"
#include "signal/disturbance.hpp"
#include "synthesis/generator/maker.hpp"
#include "synthesis/parts/series.hpp"

/// The whole analog controller as one circuit: netlist, parts list, drawing, KiCad project, JSON and both
/// simulations read the one description AnalogController.
namespace bodesmith::controller {

using generator::BranchGain;
using schematic::Contact;
using schematic::Deviations;
using schematic::Multiplier;
using schematic::OpAmp;
using schematic::Part;
using schematic::Purpose;

/// How the inverse of y = v + K d(v) is made (facts/tracking.md).
enum class Form {
  one_pass,  ///< v = r - K d(r), the disturbance paper's Fig. 2
  two_pass,  ///< v = r - K d(r - K d(r))
  self_fed,  ///< v = r - K d(v): the generator is fed by its own drive
};
std::string_view to_string(Form form);
/// "seed" (or "one-pass"), "two-pass", "self-fed". Throws InputError that lists them.
Form form_named(const std::string& name);

struct Options {
  Form form = Form::self_fed;
  schematic::MultiplierModel multiplier;
  schematic::OpAmpModel opamp;       ///< default: OPA2140
  schematic::OpAmpModel fast_opamp;  ///< of the slope detector; default: AD8066
  schematic::SwitchModel analog_switch;
  synthesis::Series resistors = synthesis::Series::named("E96");
  synthesis::Series capacitors = synthesis::Series::named("E12");
  bool rates = true;                     ///< false: rate gains left out, as the constant polynomial
  std::vector<Hertz> tracked;            ///< where the gain curve's corners are put when they fit
  double rate_tolerance_percent = 0.03;  ///< of the curve against the table, percent of range
  double averaging_s = 0.0;  ///< time constant behind the rectifier; 0: a hundredth of the shortest period
  double reference_stroke = 1.0;  ///< peak to peak of the references whose slope means frequency, V
  /// Of the references' ways between two turns the slowest, V (tracking::Reference::least_swing()): whose slope, at `lowest`, must
  /// set the switch; at most reference_stroke.
  double least_swing = std::numeric_limits<double>::infinity();
  Hertz lowest{1.0};         ///< of the slowest reference
  bool full_stroke = false;  ///< only full strokes matter: a disturbance's amplitude gains are left out

  Options();
};

/// One evaluation of v = r - K d(x). Places in AnalogController's lists.
struct Pass {
  std::string from;    ///< node whose disturbance it is: "r", "w" or "v"
  std::string x, out;  ///< nodes; x the argument: `from`, with amplitude gains `from` over the stroke
  std::vector<int> multipliers;    ///< x^2, x^3
  int branch_opamp[2] = {-1, -1};  ///< ascending, descending; none: the polynomial is 0
  /// The subtraction r - (Rg/Rin) sw: its op-amp and parts.
  struct Output {
    int opamp = -1, feedback = -1, reference = -1, disturbance = -1;
  } output;
};

/// The table's gains as straight pieces over frequency: exact at the corners, constant beyond the ends.
struct RateCurve {
  std::vector<Hertz> corner;
  std::vector<double> gain[2];  ///< ascending, descending, at the corners
  double max_error = 0.0;       ///< greatest |gain - table|, either branch

  double value(Disturbance::Branch which, Hertz frequency) const;
};

struct LoopFigures {
  double greatest_gain = 0.0;   ///< greatest |K d'(v)| over both branches, all rates and strokes
  double least_slope = 0.0;     ///< of 1 + K d'(v)
  double greatest_drive = 0.0;  ///< in strokes: V at full stroke
};

struct AnalogController : schematic::Netlist {
  Form form = Form::self_fed;
  Disturbance disturbance;
  std::vector<Hertz> tracked;
  double reference_stroke = 1.0;
  bool rates = true;

  std::vector<Pass> passes;
  double branch_gain = 1.0;  ///< V per unit of K d at the switch
  BranchGain rate[2], amplitude[2];
  std::optional<RateCurve> curve;  ///< none: no branch changes with rate
  /// The stroke alpha of the reference as a voltage (node al; an: the other sign): its last peak, the reference itself where
  /// it is higher, at least `least`. Absent without amplitude gains.
  struct Stroke {
    double least = 0.0;
    double argument_scale = 1.0;  ///< V at the generator's argument for v = alpha, by the parts
    /// Of the holds: a period's droop at the slowest reference, as a share of the stroke; what an opening contact leaves on one, V;
    /// the drive's error by both, percent of range.
    double droop = 0.0, charge_v = 0.0, hold_error_percent = 0.0;
    /// Op-amps and parts: what follows r to al, and from al to an.
    std::vector<int> follow;
    generator::GeneratorMaker::Inverter inverter;
    /// Of the node that is divided.
    struct Division {
      int above = -1, below = -1, opamp = -1, multiplier = -1;
    };
    std::map<std::string, Division> divisions = {};
  };
  std::optional<Stroke> stroke;

  /// Slope in volts: differentiator, full-wave rectifier, smoothing; none without rate gains. Op-amps and parts.
  struct SlopeMeter {
    int opamp = -1;
    int damping = -1, differentiates = -1, gain = -1, limits = -1;  ///< Rs, Cd, Rd, Cf
    int half_wave_opamp = -1, half_wave_input = -1, half_wave_feedback = -1;
    int full_wave_opamp = -1, direct = -1, half = -1, full_wave_feedback = -1, smoothing = -1;  ///< -|slope|
    double input_gain = 1.0;    ///< of the division by the stroke, where there is one
    double volts_per_hz = 0.0;  ///< of a triangle of reference_stroke, realised parts
    double smoothing_s = 0.0;
  };
  std::optional<SlopeMeter> slope;

  LoopFigures loop;
  double max_error_percent = 0.0;  ///< of K d(v) by the rounded parts and the gain curve, percent of range
  std::vector<std::string> warnings;

  const OpAmp& op(int index) const { return opamps[static_cast<std::size_t>(index)]; }
  bool switched() const { return !contacts.empty(); }
  /// The gain that a branch should have at f: the table's, or 1 (Options::rates off), or a constant table's.
  double rated_gain(Disturbance::Branch which, Hertz frequency) const;
  /// The same over the stroke: the table's, or 1 where none is built.
  double amplitude_gain(Disturbance::Branch which, double alpha) const;
};

/// Throws DesignError, one line, when it cannot be made: |K d'| reaches 1 (the stage itself has no inverse there,
/// and no loop converges), the drive leaves the supplies, a rate gain that is not above 0, parts out of reach.
AnalogController make_controller(const Disturbance& disturbance, const Options& options = {});

}  // namespace bodesmith::controller
