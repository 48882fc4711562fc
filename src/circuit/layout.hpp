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
  double scale_v = 1.05;          ///< U
  double greatest_input_v = 1.0;  ///< full-scale |X|, |Y|
  double greatest_output_v = 2.5;
  double bandwidth_hz = 250e6;
  double noise_v_per_rthz = 50e-9;
};

struct LayoutOptions {
  MultiplierModel multiplier;
  OpAmpModel opamp;
  Series resistors = Series::named("E96");
  double switch_on_ohm = 35.0;  ///< SPDT analog switch
  double full_scale_v = 1.0;    ///< greatest |voltage| wanted at every node
};

/// A block of the drawing and of the netlist.
struct LayoutMultiplier {
  std::string name;     ///< "M2"
  std::string x, y;     ///< input nodes
  std::string out;      ///< W node
  int power = 2;        ///< it makes x^power / U^(power-1)
  double peak_v = 0.0;  ///< greatest |W| for x in [0, 1]
};

/// A weight of a sum: a resistor from a power's node into a summing node.
struct LayoutWeight {
  std::string branch;  ///< "ascending" or "descending"
  int power = 1;
  double coefficient = 0.0;     ///< a_k
  std::string resistor;         ///< part name
  std::string node;             ///< summing node it feeds
  bool inverted_twice = false;  ///< goes through the first of the branch's two summers
  double wanted_ohm = 0.0;
  double realised_ohm = 0.0;
};

struct LayoutPart {
  std::string name;
  std::string role;
  std::string from, to;
  std::string series;
  double wanted_ohm = 0.0, realised_ohm = 0.0;
  double wanted_f = 0.0, realised_f = 0.0;
};

struct LayoutNode {
  std::string name;
  double lowest_v = 0.0, highest_v = 0.0;  ///< for x in [0, 1] on either branch
};

/// The disturbance generator of the first seed's Fig. 2 as a circuit: shared powers of x by multipliers, a
/// weighted sum a branch, a switch driven by the slope of the reference, an output amplifier back to 1 V per
/// unit.
struct DisturbanceLayout {
  MultiplierModel multiplier;
  OpAmpModel opamp;
  double switch_on_ohm = 0.0;
  double branch_gain = 1.0;  ///< V per unit of d at the branch sums
  std::vector<LayoutMultiplier> multipliers;
  std::vector<LayoutWeight> weights;
  std::vector<LayoutPart> parts;
  std::vector<LayoutNode> nodes;
  std::vector<std::string> warnings;
  Disturbance wanted;
  /// Coefficients that the realised resistors make.
  std::vector<double> realised_ascending, realised_descending;
  /// Greatest |realised - wanted| of d over x in [0, 1], in percent of the range of x.
  double max_error_percent = 0.0;

  double value(Disturbance::Branch branch, double x) const;
  /// Without the header.
  Json to_json() const;
};

DisturbanceLayout layout_disturbance(const Disturbance& disturbance, const LayoutOptions& options = {});

}  // namespace bodesmith
