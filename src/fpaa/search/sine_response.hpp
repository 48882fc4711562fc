#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <vector>

#include "base/units.hpp"
#include "fpaa/search/complex_pair.hpp"
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
struct Parts {
  ComplexPair end1, end2;    ///< the values at the ends of phase 1 and phase 2
  ComplexPair mean1, mean2;  ///< (1/T) int y exp(-jwt) dt over phase 1 and over phase 2

  /// The sine itself, as the board's input is.
  static Parts of_input() { return {1.0, 1.0, 0.5, 0.5}; }
  /// What the pin shows: the waveform's component at the sine's own frequency.
  ComplexPair whole() const { return mean1 + mean2; }
  /// What a reader sees whose period is an even multiple of this signal's: its phases end where this one's phase 2 does.
  Parts read_slower() const {
    const ComplexPair half = 0.5 * (mean1 + mean2);
    return {end2, end2, half, half};
  }
};

/// Of one clock at one frequency.
struct ClockFactors {
  ComplexPair half;    ///< exp(-jwT/2)
  ComplexPair period;  ///< exp(-jwT)
  ComplexPair d;       ///< 1 - exp(-jwT)
  ComplexPair sum;     ///< exp(-jwT)/d: a sampled integrator
  ComplexPair hold;    ///< (1/T) int over half a period before its end, of exp(jw(t_end - t))
};

/// From one input of a stage to its output: end1 = from1 end1 + from2 end2 (of the input), the rest by the static ratios.
struct StageFactors {
  ComplexPair from1, from2;
  double follow1 = 0.0, follow2 = 0.0;  ///< g1, g2
};

/// Where a design is judged: frequencies, what is wanted there, and how much an error there counts.
struct DesignTarget {
  std::vector<RadPerSecond> grid;
  std::vector<Complex> wanted;
  std::vector<double> weight;      ///< of |got - wanted|/reference; 1 within the band
  std::vector<double> reciprocal;  ///< 1/reference (error_reference.hpp)
  Sections sections;               ///< what is asked for
  Band band;
  double master_hz = 16e6;
};

/// Stages on a target's grid, two of whose points stand in each pair (the last one twice where their number is odd).
class StageFactorTable {
 public:
  explicit StageFactorTable(const DesignTarget& target) : target_(target) {}
  const DesignTarget& target() const { return target_; }
  std::size_t points() const { return target_.grid.size(); }
  std::size_t pairs() const { return (points() + 1) / 2; }
  const std::vector<ClockFactors>& clock(std::int64_t divisor) const;

 private:
  struct Kept {
    std::int64_t divisor;
    std::vector<ClockFactors> values;
  };
  const DesignTarget& target_;
  mutable std::deque<Kept> kept_;  ///< references stay valid
};

/// The first op-amp of a second-order stage with this input, at the ends of both phases.
struct FirstOpAmp {
  ComplexPair end1, end2;
  double largest() const { return std::max(largest_abs(end1), largest_abs(end2)); }
};
FirstOpAmp first_opamp(const DesignStage& stage, const ClockFactors& clock, const Parts& input);
/// Volts at the output's ends and parts for one unit of charge (V C_u) into an op-amp in phase 1.
Parts charge_response(const DesignStage& stage, int opamp, const ClockFactors& clock);

/// A whole design on a grid, with the way of each stage's output to the pin. Stages, pairs and points count from 0.
class DesignResponse {
 public:
  DesignResponse(const Design& design, const StageFactorTable& table);

  const Design& design() const { return design_; }
  const StageFactorTable& table() const { return table_; }
  const Parts& signal(std::size_t stage, std::size_t pair) const {
    return signals_[stage * table_.pairs() + pair];
  }
  Complex output(std::size_t point) const {
    return signal(design_.stages.size() - 1, point / 2).whole().at(point % 2);
  }
  /// weight (got - wanted)/reference.
  std::vector<Complex> errors() const;
  /// What stage `stage` reads at its input `input`.
  Parts input_of(std::size_t stage, std::size_t input, std::size_t pair) const {
    const DesignStage& reader = design_.stages[stage];
    const int from = reader.from[input];
    if (from == DesignStage::kBoardInput) return Parts::of_input();
    const auto source = static_cast<std::size_t>(from);
    const Parts& x = signal(source, pair);
    return design_.stages[source].divisor == reader.divisor ? x : x.read_slower();
  }
  /// From that input to the stage's output.
  const StageFactors& factors(std::size_t stage, std::size_t input, std::size_t pair) const {
    return factors_[(first_input_[stage] + input) * table_.pairs() + pair];
  }
  /// d pin / d (each part of each stage's output), later stages as they are; [stage * pairs + pair].
  std::vector<Parts> ways() const;

 private:
  const Design& design_;
  const StageFactorTable& table_;
  std::vector<std::size_t> first_input_;  ///< of each stage, among all inputs
  std::vector<StageFactors> factors_;
  std::vector<Parts> signals_;
};

/// The pin is linear in the response of one stage: what other capacitors of it do to the weighted output costs one stage instead
/// of all.
class StagePlace {
 public:
  /// `ways`: DesignResponse::ways().
  StagePlace(const DesignResponse& response, const std::vector<Parts>& ways, std::size_t stage);

  /// What a stage in this place adds to the weighted output.
  void share_of(const DesignStage& stage, std::vector<Complex>& out) const;
  /// d share / d ln C of every capacitor of a stage in this place, [capacitor * points + point].
  void slopes(const DesignStage& stage, Complex* out) const;
  std::size_t points() const { return points_; }

 private:
  /// Of each input and pair: share = a from1 + b from2 + c1 follow1 + c2 follow2.
  struct Weights {
    ComplexPair from1, from2, follow1, follow2;
  };
  void first_order_slopes(const DesignStage& stage, std::size_t pair, ComplexPair* out) const;
  void second_order_slopes(const DesignStage& stage, std::size_t pair, ComplexPair* out) const;

  const std::vector<ClockFactors>& clock_;
  std::size_t points_;
  std::vector<Weights> weights_;  ///< [input * pairs + pair]
};

double largest_error(const std::vector<Complex>& errors);

}  // namespace bodesmith::fpaa
