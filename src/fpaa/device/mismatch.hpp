#pragma once

#include <complex>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/documents/document.hpp"
#include "base/documents/json_fwd.hpp"
#include "schematic/netlist.hpp"

namespace bodesmith::fpaa {

/// How the capacitors of a chip differ from their whole numbers of units: the one model of `fpaa` (search and
/// budget), `yield` and `fpaa trim`. A capacitor of n units is
///   n (1 + unit_percent/100 / sqrt(n) * x) + systematic_units,   x standard normal, of each capacitor its
///   own
/// (Pelgrom, Duinmaijer and Welbers, IEEE J. Solid-State Circuits 24 (1989) 1433: n equal units side by side
/// average). The vendor publishes neither figure: both are ASSUMPTIONS that the user may set.
struct MismatchModel {
  /// k: standard deviation of one unit. The ratio of two capacitors of 50 units is off by 0.1 % with 0.5 %.
  double unit_percent = 0.5;
  /// What every capacitor has too much, on every chip alike and whatever its size (wiring, switches).
  double systematic_units = 0.0;

  /// Standard deviation of a capacitor of `units` relative to itself; 0 for one that is not there.
  double relative_sigma(double units) const;
  /// The capacitor that was drawn with the standard normal number x; never below 0.
  double drawn(double units, double x) const;

  Json to_json() const;
  /// What is not there is as in `otherwise`; figures out of range are errors with file and line.
  static MismatchModel from_node(const Node& node, MismatchModel otherwise);
};

/// An error that about 95 of 100 boards keep at one frequency: the designed complex error `offset` with a
/// random one of standard deviation `sigma` (linear: the root of the summed squares of what each capacitor
/// adds there). Cheap and smooth, for a search.
double error_of_95_percent(std::complex<double> offset, double sigma);

/// What 95 % of boards keep of an error over a grid, the quantile of
///   max_k |errors_k + sum_c x_c effects_ck|,   x_c standard normal, of so many drawn boards:
/// known to .7/sqrt(boards) where an error has two parts.
/// `effects`, [capacitor][frequency]: what a standard deviation of each capacitor adds, to the first order.
double error_of_95_percent(std::span<const std::complex<double>> errors,
                           const std::vector<std::vector<std::complex<double>>>& effects, int boards,
                           std::uint64_t seed);

/// Of which figures are stated.
inline constexpr int kDrawnBoards = 5000;

/// What kT/C noise needs besides the capacitors in units. The unit capacitance is not publicly known: an
/// ASSUMPTION that the user may set.
struct NoiseModel {
  double unit_capacitance_f = 50e-15;
  double temperature_k = 300.0;
  /// How much noise counts in a search besides the error: this times the noise in the band as a share of a
  /// full-scale sine (3 V: 2.12 V rms).
  double weight = 1.0;

  /// sqrt(kT/C_u): rms noise voltage of one unit.
  double unit_noise_v() const;
  /// rms in uV of a mean square given in kT/C_u.
  double microvolts(double mean_square_kt_per_cu) const;

  Json to_json() const;
};

/// What makes stages follow late, and settle. Of this chip's nothing is publicly known: where the user gives nothing stages follow
/// at once.
struct SlowParts {
  schematic::OpAmpModel opamp = schematic::OpAmpModel::ideal();
  double switch_s = 0.0;  ///< resistance of a closed switch times the unit of capacitance

  /// What is given of them.
  static SlowParts given(std::optional<double> bandwidth_hz, double opamp_gain,
                         std::optional<double> switch_ohm, double unit_capacitance_f);
  bool is_at_once() const { return opamp.is_ideal && switch_s == 0.0; }
  /// What such chips may have: op-amps of 20 MHz, switches of 1 kohm.
  static SlowParts typical(double unit_capacitance_f = NoiseModel().unit_capacitance_f);

  Json to_json() const;
  static SlowParts from_node(const Node& node);
};

/// All of them, in every place where a plan is judged, and the boards that are drawn there.
struct BoardAssumptions {
  MismatchModel mismatch;
  NoiseModel noise;
  SlowParts slow;
  std::uint64_t seed = 1;
};

/// How a capacitor's number chooses its units: not publicly known for this chip.
enum class UnitArray {
  nested,  ///< m units hold the n < m that were there before
  binary,  ///< groups of 1, 2, 4, … 128 units: from 127 to 128 all of them change
};

const char* to_string(UnitArray array);

/// What is known of a capacitor that goes from n to m units, when it was n + e before: s of its units stay, so
/// that it is m + e s/n and a normal error of variance
///   k^2 (s (n - s)/n + (m - s))
/// (the s that stay share e with the n - s that go; m - s are new; k of one unit as in mismatch.hpp).
struct ExchangedUnits {
  double kept = 1.0;      ///< s/n
  double variance = 0.0;  ///< units^2
};
ExchangedUnits exchanged_units(int from, int to, UnitArray array, double unit_variance);

}  // namespace bodesmith::fpaa
