#pragma once

#include <string>
#include <vector>

#include "base/units.hpp"
#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {

/// The capacitors of a filter stage: what is searched (then they need not be whole yet), and what FilterBilinear, FilterBiquad,
/// SumInv and BiquadStage are made of, each by names of its own. With D = 1 - 1/z two circuits:
///
/// One op-amp, any inputs: the sum over them of -(Cin + aCin D)/(Cout + aCout D). Cin and Cout are switched, aCin and aCout (always
/// there: it keeps the op-amp's loop closed) are not. With j tan(w/2fc) for s a branch C + aC D is C + s (C + 2 aC) but for a factor, so
/// that pole and zero are a bilinear image: tan(pi f0/fc) = C/(C + 2 aC); -Cin/Cout at rest, -(Cin + 2 aCin)/(Cout + 2 aCout) at
/// fc/2. Equal pairs are a plain gain, no aCin a low pass, no Cin a high pass.
///
/// Two op-amps, each an integrator, one input:
///   low Q:   -(+-C1 C3/z + Cp CA D   + Cpp CA D^2) / (CA D (CB D + C4) + C2 C3/z)
///   high Q:  -(+-C1 C3/z + Cp C3 D/z + Cpp CA D^2) / (CA CB D^2 + C3/z (C2 + C4 D))
/// C1 switched into the first op-amp, inverting (+, in phase 1) or not (-, taken in phase 1, given in phase 2: the second integrator
/// reads the first in phase 2, so that both signs come one period later); C2 from the output to the first op-amp; C3 from the first to
/// the second, read one period late; low Q: C4 and Cp switched into the second, high Q: both static into the first; Cpp static into the
/// second; CA, CB feedback. With real poles far apart it is the first-order low pass of a clock that is 65025 times its corner:
/// C2 C3/(CA C4).
///
/// The vendor's low pass and its band pass of low quality are in public streams (facts/an231.md, part 2); the pole-zero form is made by
/// GainInv's switches with four different values; the rest is derived from these by charge balance.
struct FilterStage {
  enum class Kind { first, second_low, second_high };
  Kind kind = Kind::first;
  /// first: Cin1, aCin1, Cin2, aCin2, …, Cout, aCout. second: C1, Cp, Cpp, C2, C3, C4, CA, CB. 0: not there.
  std::vector<double> c;
  bool c1_inverting = true;

  enum Second { kC1, kCp, kCpp, kC2, kC3, kC4, kCA, kCB };

  bool is_first() const { return kind == Kind::first; }
  std::size_t inputs() const { return is_first() ? c.size() / 2 - 1 : 1; }
  /// That AnadigmDesigner2 has a CAM for it: one input.
  bool is_vendors() const;
  int capacitor_count() const;
  int opamps() const { return is_first() ? 1 : 2; }
  /// CA or CB beyond one bank takes a second.
  Resources resources() const;
  /// Which input this capacitor reads; -1: none (a feedback).
  int input_of(std::size_t capacitor) const;
  /// An input capacitor next to a larger one of the same input: where it does not come to a unit, the stage does without.
  bool may_be_left_out(std::size_t capacitor) const;
  /// Poles inside the unit circle (Jury's conditions).
  bool is_stable() const;
  /// How large this capacitor may be: CA and CB have two banks in a stage with one input.
  double largest_units(std::size_t capacitor) const;
  /// The capacitors whose sum is switched into op-amp `opamp` (1 or 2): they bring kT/C noise there.
  double switched_units(int opamp) const;

  ZTransfer transfer() const;
  /// Pole, or where both integrators turn: w0 = 2 fc sin(pi f0/fc), by LDI.
  Hertz corner(Hertz clock) const;
  /// Low Q: CB (w0/fc)/C4; high Q: sqrt(CA CB C2/C3)/C4.
  double quality() const;
  /// Of one input where it passes: C1/C2 at DC (low pass), Cp/C4 at the centre (band pass), Cpp/CB far above (high pass); of one op-amp
  /// at rest, or at fc/2 where it is 0 there.
  double gain() const;
  /// In the vendor's order; without those that have no name. `banks`: CA and CB of two banks each.
  StageSwitches switches(const std::vector<std::string>& names, bool banks) const;
};

/// Corner frequency at which a branch C0 + C1 (1 - 1/z) turns: fc/pi atan(C0/(C0 + 2 C1)).
Hertz branch_corner(double c0, double c1, Hertz clock);

/// A CAM that is a FilterStage.
class FilterCam : public Cam {
 public:
  using Cam::Cam;
  bool place(const FilterStage& stage, PlacedCam& out) const final;
  ZTransfer transfer(const PlacedCam& cam, const CapacitorUnits& units) const final;
  std::optional<StageSwitches> switches(const PlacedCam& cam, const CapacitorUnits& units) const final;

 protected:
  /// One of its capacitors and which of the stage's it is.
  struct Named {
    std::string name;
    std::size_t at = 0;
  };
  /// Of every stage of two op-amps: C1, Cp, Cpp, C2, C3, C4, CA, CB.
  static std::vector<Named> second_order_named();
  /// In the order in which plans list them.
  virtual std::vector<Named> names(const PlacedCam& cam) const = 0;
  virtual bool makes(const FilterStage& stage) const = 0;
  virtual std::string option_of(const FilterStage& stage) const = 0;
  /// What its dialog shows of the stage.
  virtual CamValues shown(const FilterStage& stage, Hertz clock) const = 0;
  /// The stage of a placed CAM but for its capacitors' sizes: as many of them as it has.
  virtual FilterStage form(const PlacedCam& cam) const = 0;
  virtual bool banks() const { return false; }

 private:
  FilterStage stage_of(const PlacedCam& cam, const CapacitorUnits& units) const;
};

}  // namespace bodesmith::fpaa
