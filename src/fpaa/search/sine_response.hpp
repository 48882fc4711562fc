#pragma once

#include <algorithm>
#include <complex>
#include <deque>
#include <span>
#include <vector>

#include "base/units.hpp"
#include "fpaa/search/design.hpp"
#include "lti/frequency_grid.hpp"

namespace bodesmith::fpaa {

// What the switches make of a sine exp(jwt) at the board's input, exactly, at the sine's own frequency.
//
// A stage of period T has its switched input capacitors between source and virtual ground through phase 1, the first half of T,
// and away from there through phase 2; static ones stay. So within a phase its output follows the input by the ratio of
// what is connected,
//   y(t) = y(tp) - gp (x(t) - x(tp)),   tp the phase's end,   g1 = (Cin + aCin)/(Cout + aCout), g2 = aCin/aCout,
// and its values at the ends obey charge conservation. Four numbers are therefore all that a reader with the same
// clock can see of a signal; all of them times exp(jwt) at their own time.
struct SineParts {
  std::complex<double> end1 = 1.0, end2 = 1.0;    ///< the values at the ends of phase 1 and phase 2
  std::complex<double> mean1 = 0.5, mean2 = 0.5;  ///< (1/T) int y exp(-jwt) dt over phase 1 and over phase 2

  /// What the pin shows: the waveform's component at the sine's own frequency.
  std::complex<double> whole() const { return mean1 + mean2; }
  /// What a reader sees whose period is an even multiple of this signal's: its phases end where this one's phase 2 does.
  SineParts read_slower() const { return {end2, end2, 0.5 * (mean1 + mean2), 0.5 * (mean1 + mean2)}; }
};

/// Without the care for NaN and overflow that the operator takes: everything here is of moderate size.
inline std::complex<double> product(std::complex<double> a, std::complex<double> b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

/// Of one clock at one frequency.
struct ClockFactors {
  std::complex<double> half;    ///< exp(-jwT/2)
  std::complex<double> period;  ///< exp(-jwT)
  std::complex<double> d;       ///< 1 - exp(-jwT)
  std::complex<double> sum;     ///< exp(-jwT)/d: a sampled integrator
  std::complex<double> hold;    ///< (1/T) int over half a period before its end, of exp(jw(t_end - t))
};

/// From one input of a stage to its output: end1 = from1 end1 + from2 end2 (of the input), the rest by the static ratios.
struct StageFactors {
  std::complex<double> from1, from2;
  double follow1 = 0.0, follow2 = 0.0;  ///< g1, g2
};

/// Where a design is judged: frequencies, what is wanted there, and how much an error there counts.
struct DesignTarget {
  std::vector<RadPerSecond> grid;
  std::vector<std::complex<double>> wanted;
  std::vector<double> weight;      ///< of |got - wanted|/reference; 1 within the band
  std::vector<double> reciprocal;  ///< 1/reference (error_reference.hpp)
  std::vector<char> beside_zero;   ///< where mismatch says nothing relative to the response
  /// Sines spread evenly over the band's decades, whose images count, and 1/reference of each.
  std::vector<RadPerSecond> sines;
  std::vector<double> sine_reciprocal;
  Band band;
  double master_hz = 16e6;
  int max_capacitor = 255;
};

/// Stages on a target's grid.
class StageFactorTable {
 public:
  explicit StageFactorTable(const DesignTarget& target) : target_(target) {}
  const DesignTarget& target() const { return target_; }
  const std::vector<ClockFactors>& clock(std::int64_t divisor) const;

 private:
  struct Kept {
    std::int64_t divisor;
    std::vector<ClockFactors> values;
  };
  const DesignTarget& target_;
  mutable std::deque<Kept> kept_;  ///< references stay valid
};

/// A stage's charge equations with its capacitors put in, for one input.
class StageEquations {
 public:
  StageEquations(const DesignStage& stage, std::size_t input);
  StageFactors at(const ClockFactors& clock) const;

 private:
  bool first_;
  double c0_ = 0.0, c1_ = 0.0, d0_ = 0.0, d1_ = 0.0;  ///< first order: -(c0 + c1 D)/(d0 + d1 D)
  /// Second order: coefficients of what the clock makes, see SecondOrder in the source.
  double of_d_ = 0.0, of_one_ = 0.0, of_period_ = 0.0, of_sum_ = 0.0;
  double above_one_ = 0.0, above_period_ = 0.0, above_sum_ = 0.0, above_half_ = 0.0;
  double follow1_ = 0.0, follow2_ = 0.0;
};
/// The first op-amp of a second-order stage with this input, at the ends of both phases.
struct FirstOpAmp {
  std::complex<double> end1, end2;
  double largest() const { return std::max(std::abs(end1), std::abs(end2)); }
};
FirstOpAmp first_opamp(const DesignStage& stage, const ClockFactors& clock, const SineParts& input);
/// Volts at the output's ends and parts for one unit of charge (V C_u) into an op-amp in phase 1.
SineParts charge_response(const DesignStage& stage, int opamp, const ClockFactors& clock);

/// A whole design on a grid, with the way of each stage's output to the pin.
class DesignResponse {
 public:
  DesignResponse(const Design& design, const StageFactorTable& table);

  const Design& design() const { return design_; }
  const StageFactorTable& table() const { return table_; }
  std::size_t points() const { return table_.target().grid.size(); }
  /// Of every stage.
  const std::vector<std::vector<SineParts>>& signals() const { return signals_; }
  std::complex<double> output(std::size_t k) const { return signals_.back()[k].whole(); }
  /// weight (got - wanted)/reference.
  std::vector<std::complex<double>> errors() const;
  /// What stage `stage` reads at its input `input`.
  SineParts input_of(std::size_t stage, std::size_t input, std::size_t k) const;
  /// d pin / d (each part of each stage's output), later stages as they are.
  std::vector<std::vector<SineParts>> ways() const;

 private:
  const Design& design_;
  const StageFactorTable& table_;
  std::vector<std::vector<SineParts>> signals_;
};

/// The pin is linear in the response of one stage: what other capacitors of it do to the weighted errors costs one stage instead
/// of all.
class StagePlace {
 public:
  StagePlace(const DesignResponse& response, const std::vector<SineParts>& ways, std::size_t stage);

  /// What a stage in this place adds to the weighted output.
  void share_of(const DesignStage& stage, std::vector<std::complex<double>>& out) const;
  const std::vector<std::complex<double>>& share() const { return share_; }
  /// Weighted errors with the stage as it is.
  const std::vector<std::complex<double>>& errors() const { return errors_; }
  /// d share / d ln C of every capacitor of a stage in this place.
  std::vector<std::vector<std::complex<double>>> slopes(const DesignStage& stage) const;
  double largest_error_with(const DesignStage& stage, std::vector<std::complex<double>>& room) const;

 private:
  std::vector<std::vector<std::complex<double>>> second_order_slopes(const DesignStage& stage) const;

  const std::vector<ClockFactors>& clock_;
  /// Of each input and point: share = a from1 + b from2 + c1 follow1 + c2 follow2.
  struct Weights {
    std::complex<double> from1, from2, follow1, follow2;
  };
  std::vector<std::vector<Weights>> weights_;
  std::vector<std::complex<double>> errors_, share_;
};

double largest_error(const std::vector<std::complex<double>>& errors);

}  // namespace bodesmith::fpaa
