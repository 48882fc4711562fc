#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/units.hpp"
#include "fpaa/cams/cam_values.hpp"
#include "fpaa/device/board.hpp"

namespace bodesmith::fpaa {

/// A sampled transfer from one or more inputs over one denominator, in ascending powers of z^-1:
///   H(z) = (b0 + b1 z^-1 + ...) / (a0 + a1 z^-1 + ...),   z = exp(j w / fc) on the frequency axis.
/// Without holds and delays: the relation between samples. Inputs are counted from 1.
struct ZTransfer {
  std::vector<std::vector<double>> numerators{{1.0}};
  std::vector<double> denominator{1.0};

  Complex response(RadPerSecond w, Hertz clock, std::size_t input = 1) const;
  /// H(1); infinite for an integrator.
  double dc_gain(std::size_t input = 1) const;
};

/// A polynomial in powers of D = 1 - 1/z, the form in which switched-capacitor circuits are written down, in powers of 1/z, or the other
/// way round: the same change of variable. Exact for whole numbers.
std::vector<double> in_one_minus(const std::vector<double>& coefficients);

class Cam;

struct Capacitor {
  std::string name;
  int units = 0;
};

/// Capacitors by name, in unit capacitances that need not be whole: those of a placed CAM, or what mismatch
/// makes of them.
class CapacitorUnits {
 public:
  explicit CapacitorUnits(std::span<const Capacitor> capacitors);
  /// Of these sizes, in the order of the capacitors; one that is there is never quite 0.
  CapacitorUnits(std::span<const Capacitor> capacitors, std::span<const double> units);

  /// 0 for a capacitor that is not there.
  double operator[](std::string_view name) const;

 private:
  std::span<const Capacitor> capacitors_;  ///< for their names
  std::vector<double> units_;
};

/// One CAM (configurable analog module) as it is placed and realised.
struct PlacedCam {
  std::string name;          ///< unique on its chip, e.g. "Section2a"
  const Cam* cam = nullptr;  ///< which CAM it is: an entry of cam_registry()
  std::string option;        ///< "Pole and Zero", ...
  int cab = 1;               ///< 1-4
  int clock_index = 0;       ///< Clock 0-3 of its chip
  Hertz clock_a;
  int phase = 1;  ///< output phase
  CamValues requested;
  CamValues realised;
  std::vector<Capacitor> capacitors;
  ZTransfer z;                ///< exactly what the capacitors make, at clock_a, from each input to the output
  double delay_cycles = 0.0;  ///< from input sample to output, beyond z
  Resources resources;

  /// As AnadigmDesigner2 writes it: "FilterBilinear".
  std::string_view cam_name() const;
  std::size_t input_count() const { return z.numerators.size(); }
  /// z, of as many inputs as it has, as the capacitors make it.
  void find_z();
};

}  // namespace bodesmith::fpaa
