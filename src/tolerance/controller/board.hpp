#pragma once

#include <vector>

#include "synthesis/generator/at_rest.hpp"
#include "synthesis/generator/part_errors.hpp"
#include "tracking/reference.hpp"

namespace bodesmith::tolerance {

/// One repeat of a reference at an operating frequency, evenly sampled.
struct Input {
  std::vector<double> r;      ///< at the samples
  std::vector<double> slope;  ///< half a step behind each, V/s
  std::vector<double>
      to_turn;               ///< time since the last turning point; at one: the time since the one before it
  std::vector<bool> rising;  ///< at a turning point still the way before it
  double step_s = 0.0;
  double greatest_slope = 0.0;
  double switch_delay_s = 0.0;  ///< of the design, from a turning point until the new branch acts
};
Input input_of(const tracking::Reference& reference, Hertz operating, std::size_t samples);

/// One built copy as it behaves, fast: at every instant the generator is at rest (its voltages follow from
/// generator::AtRest, tabulated once as polynomials of its argument), late by its amplifiers' delays; the slope meter and
/// its smoothing are filters of first order, the switch acts late. Tests solve the netlist at every sample for the same drive.
class Board {
 public:
  /// `like`: another copy of the same wiring; where most parts are the same, this one is made several times quicker.
  Board(const generator::RestWiring& wiring, const generator::Copy& copy, const Board* like = nullptr);

  /// v over one repeat in steady state.
  std::vector<double> drive(const Input& input) const;
  /// At rest: v for r on a branch, the slope meter at `slope_v` (0: as after a slow approach).
  double at_rest(double r, bool rising, double slope_v = 0.0) const;
  /// The slope meter's voltage (0 or below) at every sample, in steady state.
  std::vector<double> slope_voltage(const Input& input) const;
  /// Mean of the slope meter's voltage, turned positive; 0 without one.
  double mean_slope_v(const Input& input) const;

 private:
  static constexpr int kTerms = 8;  ///< of the polynomials of the argument
  static constexpr int kControls =
      2;  ///< 0 and 1 V: one multiplier makes the gain, linear in its control voltage
  struct Branch {
    double term[kControls][kTerms] = {};
    bool varies = false;   ///< with the rate
    double delay_s = 0.0;  ///< of powers, sum and rate gain
  };
  void tabulate(bool rising);
  void set_delays();
  double open_node_f() const;
  double open_node_v() const;
  double open_node_ohm() const;
  double open_node_s() const;
  void mix(const Branch& branch, double control_v, double out[kTerms]) const;
  double solve(double r, double rate, const Branch& branch, const double p[kTerms], double start) const;

  const generator::RestWiring& wiring_;
  schematic::Deviations off_;
  mutable generator::AtRest rest_;    ///< remembers how its blocks were solved: a board is one thread's
  Branch branch_[2];                  ///< rising, falling
  double middle_ = 0.5, half_ = 0.7;  ///< of the argument's range
  double reference_gain_ = 1.0;
  double output_s_ = 0.0;
  double speed_ = 1.0, timing_ = 1.0;
  double charge_area_ = 0.0;  ///< V s at v, of each change of the switch
  generator::SlopeMeterGains meter_;
};

}  // namespace bodesmith::tolerance
