#pragma once

#include <algorithm>
#include <cstddef>
#include <string>

namespace bodesmith::schematic {

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

}  // namespace bodesmith::schematic
