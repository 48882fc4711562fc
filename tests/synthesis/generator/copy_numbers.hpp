#pragma once

#include <vector>

#include "synthesis/generator/part_errors.hpp"

namespace bodesmith::generator {

/// Every number of a copy, one behind the other.
inline std::vector<double> numbers_of(const Copy& copy) {
  std::vector<double> out = copy.off.part;
  const auto add = [&](const std::vector<double>& more) { out.insert(out.end(), more.begin(), more.end()); };
  add(copy.off.opamp_offset_v);
  add(copy.off.source);
  for (const schematic::MultiplierDeviation& m : copy.off.multiplier) add({m.x, m.y, m.w, m.scale, m.bend});
  add({copy.off.switch_relative, copy.off.switch_charge_c, copy.off.switch_delay_s, copy.speed, copy.timing});
  return out;
}

}  // namespace bodesmith::generator
