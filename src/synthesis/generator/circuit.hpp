#pragma once

#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schematic/netlist.hpp"
#include "signal/disturbance.hpp"
#include "synthesis/generator/maker.hpp"
#include "synthesis/parts/series.hpp"

namespace bodesmith::generator {

using schematic::Contact;
using schematic::Deviations;
using schematic::Multiplier;
using schematic::MultiplierDeviation;
using schematic::MultiplierModel;
using schematic::OpAmp;
using schematic::Part;
using schematic::Purpose;
using schematic::SwitchModel;
using schematic::SwitchTimer;

/// What controllers are made of, if nothing else is asked: multipliers and inverses add up what parts are off by.
constexpr schematic::Tolerances kPreciseParts{.resistor_percent = 0.1, .capacitor_percent = 1.0};

/// What the generator of d(x) is built into: nothing (the output is d(x)), or the inverse of y = v + K d(v) (facts/tracking.md).
enum class Form {
  open,      ///< d(x), x from outside
  one_pass,  ///< v = r - K d(r), the disturbance paper's Fig. 2
  two_pass,  ///< v = r - K d(r - K d(r))
  self_fed,  ///< v = r - K d(v): the generator is fed by its own drive
};
std::string_view to_string(Form form);
/// "seed" (or "one-pass"), "two-pass", "self-fed". Throws InputError that lists them.
Form form_named(const std::string& name);

/// How a polynomial is split for multipliers. With g powers to a group,
///   d(x) = P_0(x) + x^g (P_1(x) + x^g (P_2(x) + …)),   P_j(x) = a_{jg+1} x + … + a_{jg+g} x^g:
/// the powers up to x^g are shared by all branches, each further group costs one multiplier a branch, whose Z
/// input adds P_j. g = 1 is Horner's scheme, g >= degree shares all powers.
struct Scheme {
  static constexpr int kAutomatic = 0, kHorner = 1, kShared = 7;
  /// Bandwidth of the path over the highest reference frequency that the choice asks for.
  static constexpr double kBandwidthRatio = 20.0;
  int group = kAutomatic;

  /// "auto", "shared", "horner" or the number of powers to a group, "2" to "6". Throws InputError.
  static Scheme named(const std::string& name);
};

struct Options {
  Form form = Form::open;
  schematic::MultiplierModel multiplier;
  schematic::OpAmpModel opamp;       ///< default: open generic-10M, closed OPA2140
  schematic::OpAmpModel fast_opamp;  ///< of the slope detector; default: AD8066
  synthesis::Series resistors = synthesis::Series::named("E96");
  synthesis::Series capacitors = synthesis::Series::named("E12");
  schematic::Tolerances tolerances = kPreciseParts;
  std::optional<SwitchModel> analog_switch;  ///< none: SwitchModel::for_branches
  Hertz lowest{1.0};  ///< of the slowest reference, which the slope detector must follow

  // Open.
  double full_scale_v = 1.0;  ///< greatest |voltage| at every node but the output
  Hertz highest{5000.0};      ///< of the fastest reference
  Scheme scheme;

  // Closed.
  bool rates = true;           ///< false: rate gains left out, as the constant polynomial
  std::vector<Hertz> tracked;  ///< where the gain curve's corners are put when they fit
  /// Of the curve against the table, percent of range; doubled until resistors make its pieces.
  double rate_tolerance_percent = 0.03;
  double averaging_s = 0.0;  ///< time constant behind the rectifier; 0: a hundredth of the shortest period
  double reference_stroke = 1.0;  ///< peak to peak of the references whose slope means frequency, V
  /// Of the references' ways between two turns the slowest, V (tracking::Reference::least_swing()): whose slope, at `lowest`, must
  /// set the switch; at most reference_stroke.
  double least_swing = std::numeric_limits<double>::infinity();
  bool full_stroke = false;  ///< only full strokes matter: a disturbance's amplitude gains are left out

  explicit Options(Form form = Form::open);
};

/// One polynomial d(x) = a1 x + a2 x^2 + …; open, its node `out` carries -branch_gain * d, of its gain over the stroke too.
struct Branch {
  std::string name;
  std::vector<double> wanted;  ///< a1, a2, …
  BranchGain rate, amplitude;
  double greatest_rate = 1.0, greatest_amplitude = 1.0;  ///< of these gains
  std::vector<double> realised;  ///< what the resistors make of it, output amplifier and switch included
  std::string out;
  double peak_v = 0.0;
  double max_error_percent =
      0.0;  ///< greatest |realised - wanted| of d(x) over x in [0, 1], percent of the range of x
};

struct NodeRange {
  std::string name;
  std::string what;
  double lowest_v = 0.0, highest_v = 0.0;  ///< for x in [0, 1]
};

/// Amplitude-varying gains (disturbance paper, Fig. 3c, d) as hardware: d = g_b(alpha) d_b(x), g_b piecewise linear
/// in the stroke alpha, constant beyond its table (GeneratorMaker::build_curve). x stays the reference divided by its
/// stroke, 0 to 1 V.
struct AmplitudeControl {
  std::vector<double> alpha;
  std::vector<std::vector<double>> wanted;  ///< one table a branch
  std::vector<int> multipliers;             ///< places in DisturbanceCircuit::multipliers
  double max_error_percent = 0.0;  ///< of g_b(alpha) d_b(x) by the parts, worst alpha, percent of range
};

/// One way to split the polynomials, laid out with exact resistors and compared.
struct Candidate {
  int group = 0;
  std::string name;
  int multipliers = 0, opamps = 0;
  int depth = 0;             ///< multipliers in series
  double rss_percent = 0.0;  ///< of the error budget, worst branch
  Hertz bandwidth{0.0};      ///< of the longest path, from the sum of its lags
  bool chosen = false;
};

/// One evaluation of d(x): open the only one, closed each r - K d(x). Places in the circuit's lists.
struct Pass {
  std::string from;    ///< node whose disturbance it is: "r", "w" or "v"; open "x"
  std::string x, out;  ///< nodes; x the argument: `from`, closed with amplitude gains `from` over the stroke
  std::vector<int> multipliers;   ///< of the powers
  std::vector<int> branch_opamp;  ///< of each branch's outermost sum; -1: the polynomial is 0
  /// Back to 1 V per unit of d, -(Rg/(Rin + Ron)) sw, or the subtraction r - (Rg/Rin) sw: its op-amp and parts.
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

/// The disturbance generator of the disturbance paper's Fig. 2 as a circuit, open or closed to a controller: powers of x by
/// multipliers, shared by the branches; weighted sums; gains over the stroke and the rate; a switch driven by the slope of the
/// reference (open: with more than two branches, by select lines too); an output amplifier. Everything else reads this one
/// description: netlist, parts list, drawing, KiCad project, JSON and the simulations.
///
/// Branches come in pairs, first the one for rising x; pair s is chosen when the select lines read s in
/// binary (select1 is the lowest bit, above 0.5 V is 1). A last single branch serves both slopes.
struct DisturbanceCircuit : schematic::Netlist {
  Form form = Form::open;
  double branch_gain = 1.0;  ///< V per unit of (K) d at the switch: (Rin + Ron)/Rg of the output amplifier
  std::vector<Branch> branches;  ///< first: switch at branch > 0.5 V (ascending)
  std::vector<Pass> passes;
  double max_error_percent = 0.0;  ///< of (K) d(x) by the rounded parts and the gain curve, percent of range
  std::vector<std::string> warnings;

  // Open.
  int group = Scheme::kShared;
  double noise_gain = 1.0;  ///< greatest of the branches' sums
  std::optional<AmplitudeControl> amplitude;
  /// Alongside amplitude gains: the circuit without them, made by itself.
  std::shared_ptr<const DisturbanceCircuit> of_full_strokes;
  std::vector<NodeRange> nodes;
  std::vector<Candidate> candidates;

  // Closed.
  Disturbance disturbance;
  std::vector<Hertz> tracked;
  double reference_stroke = 1.0;
  bool rates = true;
  std::optional<RateCurve> curve;  ///< none: no branch changes with rate
  /// The stroke alpha of the reference as a voltage (node al; an: the other sign): its last peak, the reference itself where
  /// it is higher, at least `least`. Absent without amplitude gains.
  struct Stroke {
    double least = 0.0;
    double argument_scale = 1.0;  ///< V at the generator's argument for v = alpha, by the parts
    /// Of the holds: a period's droop at the slowest reference, as a share of the stroke; what an opening contact leaves on one, V;
    /// the drive's error by both, percent of range.
    double droop = 0.0, charge_v = 0.0, hold_error_percent = 0.0;
    /// By which share of a stroke alpha what is held may be off: both contacts' charge and the droop.
    double held_off(double alpha) const { return droop + 2.0 * charge_v / alpha; }
    /// Op-amps and parts: what follows r to al, and from al to an.
    std::vector<int> follow;
    GeneratorMaker::Inverter inverter;
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
    double volts_per_hz = 0.0;  ///< of a triangle of reference_stroke, realised parts
    double smoothing_s = 0.0;
  };
  std::optional<SlopeMeter> slope;
  LoopFigures loop;

  const OpAmp& op(int index) const { return opamps[static_cast<std::size_t>(index)]; }
  /// All but the sign of the slope: open, `x branch out`, with the amplitude gains `x branch amplitude out`; select lines after
  /// `branch`.
  schematic::Netlist generator() const;
  /// The sign of the slope alone.
  schematic::Netlist detector_netlist() const;
  /// Open: the pins of both as one circuit.
  std::vector<std::string> ports() const;
  /// Of the multipliers, how many make powers and groups.
  std::size_t generator_multipliers() const {
    return multipliers.size() - (amplitude ? amplitude->multipliers.size() : 0);
  }
  /// Open: g(alpha) d(x) of a branch as asked for; of its realised coefficients.
  double wanted(std::size_t branch, double x, double alpha = 1.0) const;
  double realised(std::size_t branch, double x, double alpha = 1.0) const;
  /// Open: strokes that are looked at, the table's or the full one.
  std::vector<double> strokes() const { return amplitude ? amplitude->alpha : std::vector<double>{1.0}; }
  bool switched() const { return branches.size() > 1; }
  /// Lines select1, select2, … besides `branch`.
  int select_lines() const;
  /// The branch behind select code `select` for rising or falling x; -1: none, the output rests at 0.
  int branch_at(int select, bool rising) const;
  /// Closed: the gain that a branch should have at f: the table's, or 1 (Options::rates off), or a constant table's.
  double rated_gain(Disturbance::Branch which, Hertz frequency) const;
  /// Closed: the same over the stroke: the table's, or 1 where none is built.
  double amplitude_gain(Disturbance::Branch which, double alpha) const;
};

/// Any number of polynomials of degree 1 to 7 (coefficients a1, a2, …; no constant: d(0) = 0).
struct Polynomial {
  std::string name;
  std::vector<double> coefficients;
  std::vector<double> amplitude;  ///< gains at Input::alpha; empty: 1 everywhere
};

struct Input {
  std::vector<Polynomial> branches;
  std::vector<double> alpha;  ///< empty: no amplitude-varying gains

  /// ascending, descending and their amplitude table.
  static Input of(const Disturbance& disturbance);
  /// A disturbance file. Besides the contract's keys it may list
  ///   "branches": [{"name": …, "coefficients": [a1, …, a7], "amplitude": [gain at each amplitude.alpha]}, …]
  /// (`amplitude` optional, `name` too); these then take the place of ascending and descending.
  static Input read(const std::filesystem::path& path, Provenance& from);
  static Input from_node(const Node& node);
};

/// The open circuit. Throws DesignError when a term cannot be made with the allowed parts.
DisturbanceCircuit make_layout(const Input& input, const Options& options = Options());
DisturbanceCircuit make_layout(const Disturbance& disturbance, const Options& options = Options());

/// The closed one. Throws DesignError, one line, when it cannot be made: |K d'| reaches 1 (the stage itself has no inverse there,
/// and no loop converges), the drive leaves the supplies, a rate gain that is not above 0, parts out of reach.
DisturbanceCircuit make_controller(const Disturbance& disturbance,
                                   const Options& options = Options(Form::self_fed));

/// Steps of x over [0, 1] where polynomials are compared.
constexpr int kPolynomialPoints = 1000;

/// a[0] x + a[1] x^2 + …
double polynomial(const std::vector<double>& a, double x);
/// Greatest |f| over x in [0, top].
double peak(const std::vector<double>& a, double top = 1.0);
/// Number of coefficients without trailing zeros.
int degree(const std::vector<double>& a);

/// Node in place of what the generator reads when its loop is cut.
inline constexpr const char* kArgument = "argument";

/// A controller with its loop cut: powers and weights read node kArgument instead of the last pass's argument, the switch
/// follows node branch (above 0.5 V: ascending), node slope (-V) takes the place of the slope meter. With amplitude gains the argument is
/// divided by `stroke`.
schematic::Netlist opened(const DisturbanceCircuit& controller, double stroke = 1.0);

/// A controller's generator and subtraction alone: powers, branches, switch, r - K d. What the slope meter and the gain curve make
/// comes from outside (it does not move with v). `cut`: powers and weights read node kArgument instead of the last pass's argument.
/// With amplitude gains that is what is divided by the stroke already, or, `divided`, the input of the division by node al.
schematic::Netlist generator_netlist(const DisturbanceCircuit& controller, bool cut, bool divided = false);

}  // namespace bodesmith::generator
