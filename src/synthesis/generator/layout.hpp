#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "schematic/netlist.hpp"
#include "signal/disturbance.hpp"
#include "synthesis/generator/maker.hpp"
#include "synthesis/parts/series.hpp"

namespace bodesmith::generator {

using schematic::Multiplier;
using schematic::MultiplierDeviation;
using schematic::MultiplierModel;
using schematic::Part;
using schematic::SwitchModel;
using schematic::SwitchTimer;

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
  MultiplierModel multiplier;
  schematic::OpAmpModel opamp;
  schematic::OpAmpModel fast_opamp;  ///< of the slope detector; default: AD8066
  synthesis::Series resistors = synthesis::Series::named("E96");
  std::optional<SwitchModel> analog_switch;  ///< none: SwitchModel::for_branches
  double full_scale_v = 1.0;                 ///< greatest |voltage| at every node but the output
  /// Lowest and highest reference frequency that the slope detector must follow (triangle of 0 to 1 V).
  Hertz lowest{1.0};
  Hertz highest{5000.0};
  Scheme scheme;

  Options();
};

/// One polynomial d(x) = a1 x + a2 x^2 + …; its node `out` carries -branch_gain * d, of its gain over the stroke too.
struct Branch {
  std::string name;
  std::vector<double> wanted;    ///< a1, a2, …
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
  std::vector<BranchGain> gains;            ///< one a branch
  std::vector<int> multipliers;             ///< places in Layout::multipliers
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

/// The disturbance generator of the disturbance paper's Fig. 2 as a circuit: powers of x by multipliers, shared by
/// the branches; weighted sums; a switch driven by the slope of x (and, with more than two branches, by
/// select lines); an inverting amplifier back to 1 V per unit of d.
///
/// Branches come in pairs, first the one for rising x; pair s is chosen when the select lines read s in
/// binary (select1 is the lowest bit, above 0.5 V is 1). A last single branch serves both slopes.
///
/// The netlist holds everything: the generator, with its gains over the amplitude where there is a table, and the slope detector.
struct Layout : schematic::Netlist {
  int group = Scheme::kShared;
  double full_scale_v = 1.0;
  double branch_gain =
      1.0;  ///< V per unit of d at the branches' nodes: (Rin + Ron)/Rg of the output amplifier
  double noise_gain = 1.0;                      ///< greatest of the branches' sums
  std::vector<Branch> branches;                 ///< first: switch at branch > 0.5 V (ascending)
  int output_input = -1, output_feedback = -1;  ///< parts Rin, Rg
  std::optional<AmplitudeControl> amplitude;
  std::shared_ptr<const Layout>
      of_full_strokes;  ///< beside amplitude gains: the circuit without them, made by itself
  std::vector<NodeRange> nodes;
  std::vector<Candidate> candidates;
  std::vector<std::string> warnings;
  double max_error_percent = 0.0;

  /// `x branch out`, with the amplitude gains `x branch amplitude out`; select lines after `branch`.
  schematic::Netlist generator() const;
  /// `x branch`: makes the branch signal from the slope of x.
  schematic::Netlist detector_netlist() const;
  /// The pins of both as one circuit.
  std::vector<std::string> ports() const;
  /// Of the multipliers, how many make powers and groups.
  std::size_t generator_multipliers() const {
    return multipliers.size() - (amplitude ? amplitude->multipliers.size() : 0);
  }
  /// g(alpha) d(x) of a branch as asked for; of its realised coefficients.
  double wanted(std::size_t branch, double x, double alpha = 1.0) const;
  double realised(std::size_t branch, double x, double alpha = 1.0) const;
  /// Strokes that are looked at: the table's, or the full one.
  std::vector<double> strokes() const { return amplitude ? amplitude->alpha : std::vector<double>{1.0}; }
  bool switched() const { return branches.size() > 1; }
  /// Lines select1, select2, … beside `branch`.
  int select_lines() const;
  /// The branch behind select code `select` for rising or falling x; -1: none, the output rests at 0.
  int branch_at(int select, bool rising) const;
};

/// The same for any number of polynomials of degree 1 to 7 (coefficients a1, a2, …; no constant: d(0) = 0).
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
  /// A disturbance file. Beside the contract's keys it may list
  ///   "branches": [{"name": …, "coefficients": [a1, …, a7], "amplitude": [gain at each amplitude.alpha]}, …]
  /// (`amplitude` optional, `name` too); these then take the place of ascending and descending.
  static Input read(const std::filesystem::path& path, Provenance& from);
  static Input from_node(const Node& node);
};

/// Throws DesignError when a term cannot be made with the allowed parts.
Layout make_layout(const Input& input, const Options& options = {});
Layout make_layout(const Disturbance& disturbance, const Options& options = {});

/// Steps of x over [0, 1] where polynomials are compared.
constexpr int kPolynomialPoints = 1000;

/// a[0] x + a[1] x^2 + …
double polynomial(const std::vector<double>& a, double x);
/// Greatest |f| over x in [0, 1].
double peak(const std::vector<double>& a);
/// Number of coefficients without trailing zeros.
int degree(const std::vector<double>& a);

}  // namespace bodesmith::generator
