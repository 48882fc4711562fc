#pragma once

#include <complex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/units.hpp"
#include "fpaa/cams/cam_values.hpp"
#include "fpaa/cams/z_transfer.hpp"
#include "fpaa/device/board.hpp"

namespace bodesmith::fpaa {

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
