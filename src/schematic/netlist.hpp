#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "base/units.hpp"

/// One netlist for every analog circuit of this program, whoever made it: op-amp stages and ladders, the disturbance
/// generator, the whole controller. Analyses (analysis/), drawings and netlists of simulators (writers/) read it.
namespace bodesmith::schematic {

/// An operational amplifier as far as this program needs one. Open loop
///   A(s) = A0 / (1 + s A0 / (2 pi GBW)),  behind `output_resistance_ohm`,
/// its rate of change limited to `slew_v_per_s` and its output to +-`swing_v`.
struct OpAmpModel {
  std::string name = "generic-10M";
  Hertz gain_bandwidth{10e6};
  double dc_gain = 1e6;
  double slew_v_per_s = 20e6;
  double output_resistance_ohm = 50.0;
  double swing_v = 14.1;  ///< greatest output either side of ground
  double bias_current_a = 10e-12;
  double offset_v = 0.5e-3;
  double voltage_noise_v_per_rthz = 8e-9;
  double voltage_noise_corner_hz = 100.0;  ///< 1/f corner of the voltage noise
  double current_noise_a_per_rthz = 1e-15;
  double greatest_output_current_a = 20e-3;  ///< that it drives without leaving its swing
  int per_package = 1;                       ///< op-amps in one 8-pin package: 1 or 2
  /// Stands for a nullor: its figures are far beyond any that matter, netlists have a plain source.
  bool is_ideal = false;

  /// The type "ideal".
  static OpAmpModel ideal();
  /// One pole and nothing else: no limits, no output resistance, no noise.
  static OpAmpModel one_pole(Hertz gain_bandwidth, double dc_gain);
  bool has_limits() const { return std::isfinite(slew_v_per_s); }

  Complex open_loop(RadPerSecond w) const;
};

/// An analog switch with break-before-make. All figures are typical data-sheet values, assumptions until a
/// type is bought and measured.
struct SwitchModel {
  std::string name = "ADG413";
  double on_ohm = 35.0;
  double off_siemens = 1e-10;
  double on_delay_s = 110e-9;  ///< from the control to the new contact
  double gap_s = 25e-9;        ///< both contacts open: the old one opens on_delay_s - gap_s after the control
  double charge_c = 5e-12;     ///< left on the common node by an opening contact
  double source_f = 9e-12;     ///< each contact against ground
  double drain_f = 9e-12;      ///< each contact's share of the common node

  /// Resistances alone: on_siemens + off_siemens at a control of 1 V, no delay and no charge.
  static SwitchModel plain(double on_ohm, double off_siemens);
  bool is_plain() const { return on_delay_s == 0.0; }
  /// Two contacts of an ADG413 for one or two branches; an ADG408 (8-way) for more.
  static SwitchModel for_branches(std::size_t count);
  /// Of a closed contact; a milliohm at least.
  double on_siemens() const { return 1.0 / std::max(on_ohm, 1e-3); }
  double off_delay_s() const { return on_delay_s - gap_s; }
  /// Through it a gate that swings by kGateSwing pushes the injected charge.
  static constexpr double kGateSwing = 10.0;
  double gate_f() const { return charge_c / kGateSwing; }
};

/// The netlist's switch makes both delays with one RC: charging crosses `level` after on_delay_s, discharging
/// after off_delay_s: exp(-off/tau) = level = 1 - exp(-on/tau).
struct SwitchTimer {
  double tau_s = 0.0;
  double level = 0.5;

  /// Throws DesignError unless 0 <= gap_s < on_delay_s.
  static SwitchTimer of(const SwitchModel& model);
};

/// What a part of a circuit is there for. Titles are for people.
enum class Purpose {
  stage,   ///< a stage of a chain of op-amps
  powers,  ///< multipliers that make x^2, x^3, …, shared by the branches
  branch,  ///< the weighted sum of one polynomial
  branch_switch,
  output,       ///< the amplifier behind the switch; the subtraction r - K d
  slope_sign,   ///< which branch: differentiator and comparator
  slope_meter,  ///< |slope| as a voltage
  rate_curve,   ///< corners of the gain over the slope
  rate_gain,    ///< control voltages of the branches
  amplitude,    ///< gains over the stroke
  stroke,       ///< the stroke as a voltage
  division,     ///< by the stroke
};

/// Elements that belong together: a stage, a row of the drawing, a paragraph of the netlist.
struct Group {
  std::string title;
  Purpose purpose = Purpose::stage;
};

/// What is bought: the classes of parts written into Monte Carlo decks and schematics.
/// What resistors and capacitors are bought for: drawn, ordered, and taken for granted when a built one is measured.
struct Tolerances {
  double resistor_percent = 1.0;
  double capacitor_percent = 5.0;
};

/// A resistor (ohm), a capacitor (farad) or a diode between two nodes; node "0" is ground, `from` a diode's anode.
struct Part {
  enum class Kind { resistor, capacitor, diode };
  Kind kind = Kind::resistor;
  std::string name;       ///< "R2_1": part R2 of stage 1
  std::string role;       ///< for people: "weight of x^2, ascending"
  std::size_t group = 0;  ///< place in Netlist::groups
  std::string from;
  std::string to;
  std::string series;     ///< where the realised value was taken from: "E96", "E12", "exact"; a diode's type
  double wanted = 0.0;    ///< the exact design at this impedance
  double realised = 0.0;  ///< the part that is mounted
};

struct OpAmp {
  std::string name;
  std::string role;
  std::size_t group = 0;
  std::string plus;
  std::string minus;
  std::string out;
  std::size_t type = 0;  ///< 0: Netlist::opamp; 1, 2, …: of Netlist::other_opamps
};

/// An analog multiplier of the AD835's kind: W = X Y/U + Z.
struct MultiplierModel {
  std::string name = "AD835";
  double scale_v = 1.05;  ///< U
  double greatest_input_v = 1.0;
  double greatest_output_v = 2.5;
  Hertz bandwidth{250e6};
  double noise_v_per_rthz = 50e-9;
};

/// W = X Y/U + Z between named nodes.
struct Multiplier {
  std::string name;
  std::string role;  ///< for people: "x^2/U"
  std::size_t group = 0;
  std::string x, y, z, out;
  double peak_v = 0.0;  ///< greatest |W|
};

/// One contact of a switch, closed while the switch stands at `position`.
struct Contact {
  std::string name;
  std::size_t group = 0;
  std::string from, to;
  std::string control;  ///< node whose level (0 or 1 V) opens and closes it
  int position = 0;     ///< branch: 0 the first (rising), 1 the second (falling), …
};

/// A voltage to ground that does not change.
struct Source {
  std::string name;
  std::string type;  ///< what makes it: "ADR4525 (2.5 V)"
  std::string node;
  double volts = 0.0;
  std::size_t group = 0;
};

/// A level: V(out) = .5 + .5 tanh(gain (V(in) - threshold)), 0 or 1 V.
struct Comparator {
  std::size_t group = 0;
  std::string in, out;
  double gain = 1.0;
  double threshold_v = 0.0;
};

/// A level that is 1 V where all of `high` and none of `low` are: their product.
struct Gate {
  std::size_t group = 0;
  std::string out;
  std::vector<std::string> high, low;
};

/// One phase of a clock: 1 V at `node` from t = 0 (phase 1) or from half a period (phase 2) on, for half a period less `gap`
/// of a period, over and over; 0 V in between.
struct ClockPhase {
  std::string name;
  std::string node;
  Hertz frequency;
  int phase = 1;
  double gap = 0.0;
  std::size_t group = 0;
};

/// A voltage to ground that other voltages make, as SPICE's B source says it; no analysis of this program knows it.
struct Expression {
  std::string name;
  std::string node;
  std::string volts;
  std::size_t group = 0;
};

/// A subcircuit of a library in its place.
struct Instance {
  std::string name;
  std::size_t group = 0;
  std::vector<std::string> nodes;  ///< in the order of its pins
  std::string of;
};

/// i = saturation (exp(v/(emission kT/q)) - 1), junction capacitance junction/sqrt(1 - v), diffusion charge transit * i. A
/// 1N4148's order of magnitude, assumed.
struct DiodeModel {
  double saturation_a = 2e-9;
  double emission = 1.8;
  double series_ohm = 0.5;
  double junction_f = 4e-12;
  double transit_s = 4e-9;
};

struct Netlist {
  // Made once, in the library: copies of twelve lists in each of the thirty files that hold a netlist take longest of these to compile.
  Netlist();
  Netlist(const Netlist&);
  Netlist(Netlist&&) noexcept;
  Netlist& operator=(const Netlist&);
  Netlist& operator=(Netlist&&) noexcept;
  ~Netlist();

  std::vector<Group> groups;
  std::vector<Part> parts;
  std::vector<OpAmp> opamps;
  std::vector<Multiplier> multipliers;
  std::vector<Contact> contacts;
  std::vector<Source> sources;
  std::vector<Comparator> comparators;
  std::vector<Gate> gates;
  std::vector<ClockPhase> clock_phases;
  std::vector<Expression> expressions;
  std::vector<Instance> instances;
  Tolerances tolerances;
  OpAmpModel opamp;
  std::vector<OpAmpModel> other_opamps;
  MultiplierModel multiplier;
  SwitchModel analog_switch;
  DiodeModel diode;

  const Part& part(int index) const { return parts[static_cast<std::size_t>(index)]; }
  const Part* part_named(const std::string& name) const;
  const OpAmpModel& model_of(const OpAmp& one) const {
    return one.type == 0 ? opamp : other_opamps[one.type - 1];
  }
  Purpose purpose_of(std::size_t group) const { return groups[group].purpose; }
};

/// The netlist without the elements of some groups (their places keep their numbers); parts keep their order.
template <class Keep>
Netlist subset(const Netlist& all, Keep keep) {
  Netlist out = all;
  const auto other = [&](const auto& one) { return !keep(one.group); };
  std::erase_if(out.parts, other);
  std::erase_if(out.opamps, other);
  std::erase_if(out.multipliers, other);
  std::erase_if(out.contacts, other);
  std::erase_if(out.sources, other);
  std::erase_if(out.comparators, other);
  std::erase_if(out.gates, other);
  return out;
}

/// each(element) for every element of the netlist, whatever it is.
template <class Each>
void for_each_element(Netlist& netlist, Each each) {
  const auto all = [&](auto& list) {
    for (auto& one : list) each(one);
  };
  all(netlist.parts), all(netlist.opamps), all(netlist.multipliers), all(netlist.contacts);
  all(netlist.sources), all(netlist.comparators), all(netlist.gates), all(netlist.clock_phases);
  all(netlist.expressions), all(netlist.instances);
}

/// Puts the groups into another order: `before(a, b)` of their purposes; groups of one rank keep theirs.
template <class Before>
void sort_groups(Netlist& netlist, Before before) {
  std::vector<std::size_t> order(netlist.groups.size()), place(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    return before(netlist.groups[a].purpose, netlist.groups[b].purpose);
  });
  std::vector<Group> sorted;
  for (std::size_t i = 0; i < order.size(); ++i) {
    place[order[i]] = i;
    sorted.push_back(netlist.groups[order[i]]);
  }
  netlist.groups = std::move(sorted);
  for_each_element(netlist, [&](auto& one) { one.group = place[one.group]; });
}

/// One multiplier's departures from W = X Y/U + Z:
///   W = (X + x)(Y + y)/(U (1 + scale)) (1 + bend) + Z + w.
struct MultiplierDeviation {
  double x = 0.0, y = 0.0, w = 0.0, scale = 0.0, bend = 0.0;

  double product(double scale_v, double at_x, double at_y) const {
    return (at_x + x) * (at_y + y) / (scale_v * (1.0 + scale)) * (1.0 + bend);
  }
  bool any() const { return x != 0.0 || y != 0.0 || w != 0.0 || scale != 0.0 || bend != 0.0; }
};

/// What one built copy has different from its netlist; nothing else knows errors of parts.
struct Deviations {
  std::vector<double> part;                     ///< relative, by place in Netlist::parts
  std::vector<double> opamp_offset_v;           ///< at the input, by place in Netlist::opamps
  std::vector<MultiplierDeviation> multiplier;  ///< by place in Netlist::multipliers
  std::vector<double> source;                   ///< relative, by place in Netlist::sources
  double switch_relative = 0.0;                 ///< of the contacts' resistance
  double switch_charge_c = 0.0;                 ///< in addition to the model's
  double switch_delay_s = 0.0;                  ///< in addition to the model's

  /// Every list at its length, all 0.
  static Deviations none(const Netlist& netlist) {
    Deviations out;
    out.part.assign(netlist.parts.size(), 0.0);
    out.opamp_offset_v.assign(netlist.opamps.size(), 0.0);
    out.multiplier.assign(netlist.multipliers.size(), {});
    out.source.assign(netlist.sources.size(), 0.0);
    return out;
  }

  /// Of a netlist whose elements are some of `whole`'s, by their names; others are as realised.
  Deviations of_part(const Netlist& part_of_it, const Netlist& whole) const;

  double value(const Netlist& netlist, int index) const {
    const auto i = static_cast<std::size_t>(index);
    return netlist.parts[i].realised * (1.0 + part[i]);
  }
  /// The contacts as they are.
  SwitchModel contact(SwitchModel model) const {
    model.on_ohm *= 1.0 + switch_relative;
    model.charge_c += switch_charge_c;
    model.on_delay_s += switch_delay_s;
    return model;
  }
  double offset(int opamp) const { return opamp_offset_v[static_cast<std::size_t>(opamp)]; }
};

}  // namespace bodesmith::schematic
