#pragma once

#include <vector>

#include "schematic/netlist.hpp"

namespace bodesmith::schematic {

/// One multiplier's departures from W = X Y/U + Z:
///   W = (X + x)(Y + y)/(U (1 + scale)) (1 + bend) + Z + w.
struct MultiplierDeviation {
  double x = 0.0, y = 0.0, w = 0.0, scale = 0.0, bend = 0.0;

  double product(double scale_v, double at_x, double at_y) const {
    return (at_x + x) * (at_y + y) / (scale_v * (1.0 + scale)) * (1.0 + bend);
  }
  bool any() const { return x != 0.0 || y != 0.0 || w != 0.0 || scale != 0.0 || bend != 0.0; }
};

/// What one built copy has different from its netlist; nothing else knows errors of parts.
struct Deviations {
  std::vector<double> part;                     ///< relative, by place in Netlist::parts
  std::vector<double> opamp_offset_v;           ///< at the input, by place in Netlist::opamps
  std::vector<MultiplierDeviation> multiplier;  ///< by place in Netlist::multipliers
  std::vector<double> source;                   ///< relative, by place in Netlist::sources
  double switch_relative = 0.0;                 ///< of the contacts' resistance
  double switch_charge_c = 0.0;                 ///< beside the model's
  double switch_delay_s = 0.0;                  ///< beside the model's

  /// Every list at its length, all 0.
  static Deviations none(const Netlist& netlist) {
    Deviations out;
    out.part.assign(netlist.parts.size(), 0.0);
    out.opamp_offset_v.assign(netlist.opamps.size(), 0.0);
    out.multiplier.assign(netlist.multipliers.size(), {});
    out.source.assign(netlist.sources.size(), 0.0);
    return out;
  }

  /// Of a netlist whose elements are some of `whole`'s, by their names; others are as realised.
  Deviations of_part(const Netlist& part_of_it, const Netlist& whole) const;

  double value(const Netlist& netlist, int index) const {
    const auto i = static_cast<std::size_t>(index);
    return netlist.parts[i].realised * (1.0 + part[i]);
  }
  /// The contacts as they are.
  SwitchModel contact(SwitchModel model) const {
    model.on_ohm *= 1.0 + switch_relative;
    model.charge_c += switch_charge_c;
    model.on_delay_s += switch_delay_s;
    return model;
  }
  double offset(int opamp) const { return opamp_offset_v[static_cast<std::size_t>(opamp)]; }
};

}  // namespace bodesmith::schematic
