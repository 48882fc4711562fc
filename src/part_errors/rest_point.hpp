#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "controller/controller.hpp"
#include "schematic/deviations.hpp"

namespace bodesmith::part_errors {

/// The order in which a controller's voltages at rest follow from one another, worked out once from its
/// description: sums, rectifiers, multipliers, dividers, followers, the switch. Forced from outside are r, the
/// argument v (where the generator is fed by its own drive) and the slope meter's voltage.
class Wiring {
 public:
  explicit Wiring(const controller::AnalogController& controller);

  struct Element {
    enum class Kind { sum, rectifier, multiplier, divider, follower, contact };
    Kind kind = Kind::sum;
    std::vector<int> in;  ///< nodes; of a contact: while rising, while falling
    int out = 0;
    int index = 0;    ///< in the list of its kind; of a divider: the upper part, of a follower: the op-amp
    int second = -1;  ///< of a divider: the lower part
  };

  static constexpr int kGround = 0, kReference = 1, kDrive = 2, kMade = 3, kSlope = 4;
  /// The gain curve: slope to control voltages. Then powers, branches, switch and subtraction.
  const std::vector<Element>& rate() const { return rate_; }
  const std::vector<Element>& generator() const { return generator_; }
  std::size_t nodes() const { return count_; }
  /// -1: no such node.
  int node(const std::string& name) const;
  const controller::AnalogController& controller() const { return controller_; }
  /// The generator's argument is its own drive.
  bool self_fed() const { return controller_.form == controller::Form::self_fed; }

 private:
  int number(const std::string& name);
  int output_number(const std::string& name);
  void collect(std::vector<Element>& out);
  void collect_dividers(std::vector<Element>& out);
  void order(std::vector<Element> all);

  const controller::AnalogController& controller_;
  std::map<std::string, int> names_;
  std::size_t count_ = 5;
  std::vector<Element> rate_, generator_;
};

/// One built copy at rest: the wiring with this copy's gains and offsets.
class RestPoint {
 public:
  RestPoint(const Wiring& wiring, const schematic::Deviations& off);

  /// The slope meter's voltage (0 or below); the control voltages follow.
  void set_slope(double volts);
  /// A voltage in place of what the gain curve makes there; -1: none.
  void force(int node, double volts) {
    if (node >= 0) v_[static_cast<std::size_t>(node)] = volts;
  }
  /// v that the subtraction makes for r and the generator's argument v (ignored unless self-fed).
  double made(double r, double v, bool rising);
  /// Of the last evaluation.
  double volts(int node) const { return v_[static_cast<std::size_t>(node)]; }
  double volts(const std::string& node) const;
  /// dv/dr of the subtraction, the argument held.
  double reference_gain() const { return reference_gain_; }
  /// 1 + Rf (sum of conductances at the inverting input) of a sum.
  double noise_gain(int sum) const { return noise_gain_[static_cast<std::size_t>(sum)]; }

 private:
  struct Step {
    Wiring::Element::Kind kind = Wiring::Element::Kind::sum;
    int out = 0;
    std::size_t first = 0, count = 0;  ///< in in_ and gain_
    double constant = 0.0;
    double x = 0.0, y = 0.0, w = 0.0, per_scale = 1.0, curve_x = 0.0;
    bool positive = false;
  };
  Step step_of(const Wiring::Element& element, const schematic::Deviations& off);
  void sum_step(Step& step, const Wiring::Element& element, const schematic::Deviations& off);
  void run(const std::vector<Step>& steps, bool rising);

  const Wiring& wiring_;
  std::vector<int> in_;
  std::vector<double> gain_;
  std::vector<Step> rate_, generator_;
  std::vector<double> v_;
  std::vector<double> noise_gain_;
  double reference_gain_ = 1.0;
};

}  // namespace bodesmith::part_errors
