#pragma once

#include <complex>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "base/units.hpp"
#include "lti/frequency_grid.hpp"
#include "lti/sections.hpp"

namespace bodesmith::fpaa {

/// One stage of a design while it is searched: capacitors that need not be whole yet, wired to other stages.
struct NetworkStage {
  enum class Kind {
    first,  ///< sum over inputs of -(Cin + aCin D)/(Cout + aCout D): SumInv, low pass, pole and zero, gain
    second_low,   ///< BiquadStage, low Q
    second_high,  ///< BiquadStage, high Q
  };
  Kind kind = Kind::first;
  std::string name;
  std::int64_t divisor = 1;  ///< of the master clock
  std::vector<int> from;     ///< what feeds each input: a stage before this one, or kBoardInput
  /// first: Cin1, aCin1, Cin2, aCin2, …, Cout, aCout. second: C1, Cp, Cpp, C2, C3, C4, CA, CB. 0: not there.
  std::vector<double> c;
  bool c1_inverting = true;
  std::vector<char> free;  ///< those that the continuous fit moves (the others only fix the scale)

  static constexpr int kBoardInput = -1;
  enum Second { kC1, kCp, kCpp, kC2, kC3, kC4, kCA, kCB };

  int capacitor_count() const;
  int opamps() const { return kind == Kind::first ? 1 : 2; }
  /// Reads input `input` (from 0), D = 1 - 1/z.
  std::complex<double> response(std::size_t input, std::complex<double> d) const;
  bool is_stable() const;
  /// |first op-amp of a second-order stage| for 1 V at its input (biquad_stage.hpp).
  double inner_gain(std::complex<double> d) const;
  /// How large this capacitor may be: CA and CB have two banks in a stage with one input.
  double largest_units(std::size_t capacitor, int max_capacitor) const;
};

/// Without the care for NaN and overflow that the operator takes: everything here is of moderate size.
inline std::complex<double> product(std::complex<double> a, std::complex<double> b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

/// a0 + a1 D + a2 D^2.
struct InD {
  double a0 = 0.0, a1 = 0.0, a2 = 0.0;

  std::complex<double> at(std::complex<double> d) const { return a0 + product(d, a1 + a2 * d); }
};
/// A stage's response from one input is -(numerator)/(denominator).
InD numerator_of(const NetworkStage& stage, std::size_t input);
InD denominator_of(const NetworkStage& stage);

/// One stage on a grid: numerators and derivatives share what everything is divided by.
class StageOnGrid {
 public:
  /// Both must outlive it. `d`: 1 - 1/z on the grid.
  StageOnGrid(const NetworkStage& stage, const std::vector<std::complex<double>>& d);

  std::vector<std::complex<double>> response(std::size_t input) const;
  /// d response / d ln c[capacitor], from one input.
  std::vector<std::complex<double>> derivative(std::size_t input, std::size_t capacitor,
                                               const std::vector<std::complex<double>>& response) const;

 private:
  const NetworkStage& stage_;
  const std::vector<std::complex<double>>& d_;
  std::vector<std::complex<double>> inverse_;
};

/// Stages in an order in which each reads only those before it; the last drives the output pin.
struct Network {
  std::vector<NetworkStage> stages;
  int opamps() const;
};

/// Where a design is judged: frequencies, what is wanted there, and how much an error there counts.
struct NetworkTarget {
  std::vector<RadPerSecond> grid;
  std::vector<std::complex<double>> wanted;
  std::vector<double> weight;      ///< of |got/wanted - 1|; 1 within the band
  std::vector<double> reciprocal;  ///< 1/|wanted|, its zeros softened
  Band band;
  double master_hz = 16e6;
  int max_capacitor = 255;
};

/// Evaluates networks on a target's grid, as they run: every clock and hold. Clocks that are read by another
/// one are whole multiples of it or divide it, so that no line folds back (see MultirateResponse).
class NetworkResponse {
 public:
  explicit NetworkResponse(const NetworkTarget& target) : target_(target) {}

  /// Of every stage from each of its inputs, what reading makes of the source's held output included.
  using Transfers = std::vector<std::vector<std::vector<std::complex<double>>>>;
  Transfers transfers(const Network& network) const;

  /// Of every stage, at its own samples.
  std::vector<std::vector<std::complex<double>>> nodes(const Network& network) const;
  std::vector<std::vector<std::complex<double>>> nodes(const Network& network, const Transfers& made) const;
  /// At the output pin, held.
  std::vector<std::complex<double>> output(const Network& network) const;
  /// weight (got/wanted - 1).
  std::vector<std::complex<double>> errors(const Network& network) const;
  /// From each stage's output to the output pin (hold of the last included).
  std::vector<std::vector<std::complex<double>>> onward(const Network& network) const;
  std::vector<std::vector<std::complex<double>>> onward(const Network& network, const Transfers& made) const;

  /// 1 - 1/z at a clock, on the grid.
  const std::vector<std::complex<double>>& d_of(std::int64_t divisor) const;
  /// What reading makes of the held output of `source` at clock `reader`.
  const std::vector<std::complex<double>>& read_of(std::int64_t source, std::int64_t reader) const;
  /// The hold of the output pin.
  const std::vector<std::complex<double>>& hold_of(std::int64_t divisor) const;
  const NetworkTarget& target() const { return target_; }

 private:
  struct Kept {
    std::int64_t a, b;
    std::vector<std::complex<double>> values;
  };
  const std::vector<std::complex<double>>& kept(std::deque<Kept>& list, std::int64_t a, std::int64_t b,
                                                std::complex<double> (*make)(double f, std::int64_t a,
                                                                             std::int64_t b)) const;
  const NetworkTarget& target_;
  mutable std::deque<Kept> d_, read_, hold_;  ///< references stay valid
};

/// Largest |error| of a list.
double largest_error(const std::vector<std::complex<double>>& errors);

}  // namespace bodesmith::fpaa
