#include "schematic/deviations.hpp"

namespace bodesmith::schematic {
namespace {

template <class Element, class Value>
void take(const std::vector<Element>& elements, const std::vector<Element>& whole,
          const std::vector<Value>& from, std::vector<Value>& to) {
  // Mostly in the same order.
  std::size_t k = 0;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    for (std::size_t tries = 0; tries < whole.size(); ++tries, k = (k + 1) % whole.size()) {
      if (whole[k].name != elements[i].name) continue;
      to[i] = from[k];
      break;
    }
  }
}

}  // namespace

Deviations Deviations::of_part(const Netlist& part_of_it, const Netlist& whole) const {
  Deviations out = *this;
  const Deviations nothing = none(part_of_it);
  out.part = nothing.part;
  out.opamp_offset_v = nothing.opamp_offset_v;
  out.multiplier = nothing.multiplier;
  out.source = nothing.source;
  take(part_of_it.parts, whole.parts, part, out.part);
  take(part_of_it.opamps, whole.opamps, opamp_offset_v, out.opamp_offset_v);
  take(part_of_it.multipliers, whole.multipliers, multiplier, out.multiplier);
  take(part_of_it.sources, whole.sources, source, out.source);
  return out;
}

}  // namespace bodesmith::schematic
