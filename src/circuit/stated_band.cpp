#include "circuit/stated_band.hpp"

#include <algorithm>

namespace bodesmith::circuit {
namespace {

bool states_a_band(const Sections& sections) {
  return sections.error && sections.error->band.from.value > 0.0 &&
         sections.error->band.to > sections.error->band.from;
}

}  // namespace

Band judged_band(const Sections& sections) {
  if (states_a_band(sections)) return sections.error->band;
  const Band corners = sections.corner_band();
  if (corners.to.value == 0.0) return {Hertz{1.0}, Hertz{1000.0}};
  // One corner is no band.
  if (!(corners.to > corners.from)) return {Hertz{corners.from.value / 10.0}, Hertz{corners.to.value * 10.0}};
  return corners;
}

Band searched_band(const Sections& sections) {
  const Band corners = sections.corner_band();
  if (corners.to.value == 0.0) return {Hertz{1.0}, Hertz{1000.0}};
  Band out = corners;
  if (states_a_band(sections)) {
    out.from = std::clamp(sections.error->band.from, corners.from, corners.to);
    out.to = std::clamp(sections.error->band.to, corners.from, corners.to);
  }
  return {Hertz{out.from.value / 10.0}, Hertz{out.to.value * 10.0}};
}

}  // namespace bodesmith::circuit
