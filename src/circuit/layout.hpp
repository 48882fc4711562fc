#pragma once

#include <string>
#include <vector>

#include "base/json.hpp"
#include "circuit/opamp.hpp"
#include "circuit/series.hpp"
#include "signal/disturbance.hpp"

namespace bodesmith {

/// An analog multiplier of the AD835's kind: W = X Y/U + Z.
struct MultiplierModel {
  std::string name = "AD835";
  double scale_v = 1.05;  ///< U
  double greatest_input_v = 1.0;
  double greatest_output_v = 2.5;
  Hertz bandwidth{250e6};
  double noise_v_per_rthz = 50e-9;
};

struct LayoutOptions {
  MultiplierModel multiplier;
  OpAmpModel opamp;
  Series resistors = Series::named("E96");
  double switch_on_ohm = 35.0;  ///< of the analog switch between the branches
  double full_scale_v = 1.0;    ///< greatest |voltage| at every node
  /// Lowest and highest reference frequency that the slope detector must follow (triangle of 0 to 1 V).
  Hertz lowest{1.0};
  Hertz highest{5000.0};
};

/// M_k: W = X Y/U makes x^k / U^(k-1) of two lower powers.
struct LayoutMultiplier {
  std::string name;
  int power = 2;
  int x_power = 1;
  int y_power = 1;
  std::string x, y, out;  ///< nodes
  double peak_v = 0.0;    ///< greatest |W| for x in [0, 1]
};

struct LayoutPart {
  enum class Kind { resistor, capacitor };
  Kind kind = Kind::resistor;
  std::string name;
  std::string role;  ///< for people: "weight of x^2, ascending"
  std::string from, to;
  std::string series;
  double wanted = 0.0;
  double realised = 0.0;
};

/// One polynomial d(x) = a1 x + a2 x^2 + …, made by one op-amp that sums with both signs: terms that must
/// come out negative enter at its inverting input (gain -Rf/Rk), positive ones at the other through equal
/// conductances, and `balance` at one of the inputs makes the conductances at both equal. Its output is
/// -branch_gain * d(x).
struct LayoutBranch {
  std::string name;
  std::vector<double> wanted;    ///< a1, a2, …
  std::vector<double> realised;  ///< what the resistors make of it, output amplifier and switch included
  std::string plus, minus, out;  ///< nodes
  /// Places in DisturbanceLayout::parts. weight[k] < 0: no such term.
  std::vector<int> weight;
  std::vector<bool> at_plus;
  int feedback = -1;
  int balance = -1;
  double peak_v = 0.0;
  double max_error_percent =
      0.0;  ///< greatest |realised - wanted| of d(x) over x in [0, 1], percent of the range of x

  double value(double x) const;  ///< with `realised`
};

struct LayoutNode {
  std::string name;
  std::string what;
  double lowest_v = 0.0, highest_v = 0.0;  ///< for x in [0, 1]
};

/// The disturbance generator of the first seed's Fig. 2 as a circuit: powers of x by multipliers, shared by
/// the branches; one summing op-amp a branch; a switch driven by the slope of x; an inverting amplifier back
/// to 1 V per unit of d.
struct DisturbanceLayout {
  MultiplierModel multiplier;
  OpAmpModel opamp;
  double switch_on_ohm = 0.0;
  double full_scale_v = 1.0;
  double branch_gain = 1.0;  ///< V per unit of d at the branch sums: (Rin + Ron)/Rg of the output amplifier
  std::vector<LayoutMultiplier> multipliers;
  std::vector<LayoutBranch> branches;           ///< first: switch at branch > 0.5 V (ascending)
  int output_input = -1, output_feedback = -1;  ///< parts Rin, Rg
  std::vector<int> detector;                    ///< parts of the slope detector
  std::vector<LayoutPart> parts;
  std::vector<LayoutNode> nodes;
  std::vector<std::string> warnings;
  double max_error_percent = 0.0;

  const LayoutPart& part(int index) const { return parts[static_cast<size_t>(index)]; }
  const LayoutPart* part_named(const std::string& name) const;
  double value(Disturbance::Branch branch, double x) const {
    return branches[branch == Disturbance::Branch::ascending || branches.size() == 1 ? 0 : 1].value(x);
  }
  /// Without the header.
  Json to_json() const;
};

/// Throws DesignError when a term cannot be made with the allowed parts.
DisturbanceLayout layout_disturbance(const Disturbance& disturbance, const LayoutOptions& options = {});

/// The same for one or two polynomials of degree 1 to 7 (coefficients a1, a2, …; no constant: d(0) = 0).
struct LayoutPolynomial {
  std::string name;
  std::vector<double> coefficients;
};
DisturbanceLayout layout_polynomials(const std::vector<LayoutPolynomial>& branches,
                                     const LayoutOptions& options = {});

/// The schematic as SVG.
std::string layout_drawing(const DisturbanceLayout& layout);

}  // namespace bodesmith
