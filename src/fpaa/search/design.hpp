#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace bodesmith::fpaa {

/// One stage of a design while it is searched: capacitors that need not be whole yet, wired to other stages.
struct DesignStage {
  enum class Kind {
    first,  ///< sum over inputs of -(Cin + aCin D)/(Cout + aCout D): SumInv, low pass, pole and zero, gain
    second_low,   ///< the two integrators of BiquadStage (biquad_stage.hpp), low Q
    second_high,  ///< the same, high Q
  };
  Kind kind = Kind::first;
  std::string name;
  std::int64_t divisor = 1;  ///< of the master clock
  std::vector<int> from;     ///< what feeds each input: a stage before this one, or kBoardInput
  /// first: Cin1, aCin1, Cin2, aCin2, …, Cout, aCout. second: C1, Cp, Cpp, C2, C3, C4, CA, CB. 0: not there.
  std::vector<double> c;
  bool c1_inverting = true;
  bool whole = false;  ///< its capacitors are whole units: nothing in it is fitted any more

  static constexpr int kBoardInput = -1;
  enum Second { kC1, kCp, kCpp, kC2, kC3, kC4, kCA, kCB };

  bool is_first() const { return kind == Kind::first; }
  /// That AnadigmDesigner2 has a CAM for it: one input.
  bool is_vendors() const;
  int capacitor_count() const;
  int opamps() const { return is_first() ? 1 : 2; }
  /// That the continuous fit may move it (the others only fix the stage's scale).
  bool is_free(std::size_t capacitor) const;
  /// Which input this capacitor reads; -1: none (a feedback).
  int input_of(std::size_t capacitor) const;
  /// An input capacitor beside a larger one of the same input: where it does not come to a unit, the stage does without.
  bool may_be_left_out(std::size_t capacitor) const;
  /// Poles inside the unit circle (Jury's conditions).
  bool is_stable() const;
  /// How large this capacitor may be: CA and CB have two banks in a stage with one input.
  double largest_units(std::size_t capacitor, int max_capacitor) const;
  /// The capacitors whose sum is switched into op-amp `opamp` (1 or 2): they bring kT/C noise there.
  double switched_units(int opamp) const;
};

/// Stages in an order in which each reads only those before it; the last drives the output pin. No stage reads a slower
/// one, and the periods of two clocks that meet have an even ratio: then whatever a slower clock sees of a
/// faster one repeats within each of its own phases, and sine_response.hpp is exact.
struct Design {
  std::vector<DesignStage> stages;
  int opamps() const;
  /// Stage `stage`'s output times `factor`, and whatever reads it divided by it: the response stays.
  void scale_node(std::size_t stage, double factor);
};

/// To a millionth: what two processors make of one search differs in the last digits, and what is chosen from it should not.
double snapped(double value);

}  // namespace bodesmith::fpaa
