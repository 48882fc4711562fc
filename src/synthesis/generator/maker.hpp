#pragma once

#include <string>
#include <vector>

#include "base/error.hpp"
#include "synthesis/parts/netlist_maker.hpp"

/// What the disturbance generator is made of, open and closed on its own drive (circuit.hpp): powers and
/// weighted sums, gains that follow a voltage, the sign of a slope.
namespace bodesmith::generator {

constexpr int kMostPowers = 7;
/// Greatest |voltage| aimed at, as a share of full scale: room for what E-series resistors round.
constexpr double kRoom = 0.97;
/// Of the voltage reference.
constexpr double kReferenceV = 2.5;

/// "x", "x^2", …
std::string power_text(int power);
/// "a" and "d" for two branches, "" for one, "1_", "2_", … for more: between the kind and the number of a part.
std::string branch_letter(std::size_t branch, std::size_t count = 2);

/// A gain of one branch that a control voltage changes: at_rest (direct + control/U).
struct BranchGain {
  double at_rest = 1.0;  ///< in the weights of the branch
  /// 1: Z is fed by the branch, only the departure from at_rest goes through the product's errors; 0: the product is the gain.
  double direct = 1.0;
  int control = -1;  ///< op-amp that makes the control voltage; none: constant

  /// For gains from `least` to `most`: about the middle where the control voltage stays within the multiplier's range.
  static BranchGain between(double least, double most, const schematic::MultiplierModel& multiplier);
};

/// Gains of all branches as straight pieces over a voltage s: exact at the corners, constant beyond the ends.
struct GainCurve {
  std::string what;                   ///< the gain goes by: "rate"
  schematic::Purpose corners, of;     ///< of the rectifiers, of the control voltages
  std::string node;                   ///< carries -s
  std::string rectifiers;             ///< begins their nodes' names
  std::string control, inverted;      ///< begin the names of the control voltages
  std::string multiplier, gained;     ///< begin the names of multipliers and what they make
  std::vector<double> corner_v = {};  ///< rising
  std::vector<std::string> corner_text = {};
  std::vector<std::vector<double>> gain = {};  ///< of each branch at the corners

  static GainCurve over_rate();       ///< of node sn
  static GainCurve over_amplitude();  ///< of node an
  std::string rectifier(std::size_t corner) const { return rectifiers + std::to_string(corner + 1); }
  bool varies(std::size_t branch) const;
};

/// x^k of a node as voltages: U (scale V(x)/U)^k.
struct Powers {
  std::string x;                      ///< whose powers they are
  std::string scaled;                 ///< what the multipliers read
  std::string tail;                   ///< ends the names
  double scale = 1.0;                 ///< V at `scaled` for x = 1
  double first = 1.0;                 ///< V at x for x = 1
  std::vector<int> multipliers = {};  ///< in rising order of the powers

  std::string node(int power) const { return power == 1 ? x : "x" + std::to_string(power) + tail; }
  double level(int power, const schematic::MultiplierModel& multiplier) const;
};

/// No resistors make a gain curve's pieces: longer ones are flatter.
class TooSteep : public DesignError {
 public:
  using DesignError::DesignError;
};

class GeneratorMaker : public synthesis::NetlistMaker {
 public:
  GeneratorMaker(schematic::Netlist& to, const synthesis::Series& resistors,
                 const synthesis::Series& capacitors, std::vector<std::string> branch_names)
      : NetlistMaker(to, resistors, capacitors), names_(std::move(branch_names)) {}

  const std::string& name(std::size_t branch) const { return names_[branch]; }
  std::string letter(std::size_t branch) const { return branch_letter(branch, names_.size()); }
  /// What is added next belongs to the group of that title, which is made where there is none.
  void enter(const std::string& title, schematic::Purpose purpose);
  /// DesignError beyond the multiplier's output.
  int multiplier(const std::string& name, const std::string& role, const std::string& x, const std::string& y,
                 const std::string& z, const std::string& to, double peak_v);

  /// Fewest multipliers for the powers that `needed` (by power) names: x^k from the two halves of k, which may have to be
  /// made too. `top`: greatest x.
  void make_powers(Powers& powers, std::vector<bool> needed, double top);
  struct WeightedSum {
    int opamp = -1;
    double noise_gain = 1.0;
    std::vector<double> realised;  ///< of the terms, as their weights are
  };
  /// volts (a_1 x + a_2 x^2 + …) at `node`. `power`: what the first term counts as, with groups of powers; `suffix` ends the
  /// names of what the sum has once.
  WeightedSum weighted_sum(const Powers& powers, const std::vector<double>& a, double volts,
                           std::size_t branch, const std::string& node, int power = 1,
                           const std::string& suffix = "");

  /// -V(from) at `to`: the places of both resistors.
  struct Inverter {
    int opamp = -1, input = -1, feedback = -1;
  };
  Inverter invert(const std::string& role, const std::string& from, const std::string& to);
  void reference();
  /// Rectifiers and control voltages of the gains that vary.
  void build_curve(const GainCurve& curve, const std::vector<BranchGain*>& gains);
  /// The node behind a branch's gain; `node` itself where it does not vary.
  std::string vary(const GainCurve& curve, const BranchGain& gain, std::size_t branch,
                   const std::string& node, const std::string& tail, double peak_v);

  /// The sign of a node's slope, op-amp level at node so: a differentiator with a logarithmic limit and a comparator with
  /// hysteresis. How late it is: sqrt(dV/(2 pi GBW ds)), dV the diodes' voltage and ds the slope, at least; hence the faster
  /// op-amp. `stroke`: of the least triangle, V, at `lowest`.
  void slope_sign(const std::string& input, double stroke, Hertz lowest);

 private:
  int control(const GainCurve& curve, std::size_t branch, const BranchGain& gain);

  std::vector<std::string> names_;  ///< of the branches
};

/// The groups in the order of the netlist.
void arrange(schematic::Netlist& netlist);

}  // namespace bodesmith::generator
