#include "circuit_options.hpp"

#include <cmath>

#include "base/text.hpp"

namespace bodesmith::python {

synthesis::RealiseOptions circuit_options(const Node& options) {
  synthesis::RealiseOptions out;
  out.realisation = options.string_or("realization", out.realisation);
  out.resistors = synthesis::Series::named(options.string_or("series", "E96"));
  out.capacitors = synthesis::Series::named(
      options.string_or("capacitor_series", out.resistors.is_exact() ? "exact" : "E12"));
  return out;
}

fpaa::MismatchModel mismatch_of(const Node& options) {
  fpaa::MismatchModel out;
  out.unit_percent = options.number_or("unit_capacitor_percent", out.unit_percent);
  out.systematic_units = options.number_or("systematic_units", out.systematic_units);
  if (!(out.unit_percent >= 0.0) || !(out.unit_percent < 100.0))
    options.at("unit_capacitor_percent").fail("is out of range, expected 0 or more and less than 100");
  if (!(std::abs(out.systematic_units) < 1.0))
    options.at("systematic_units").fail("is out of range, expected more than -1 and less than 1");
  return out;
}

Sections rational_part(Sections sections, std::vector<std::string>& warnings) {
  if (sections.delay_s == 0.0) return sections;
  warnings.push_back("the delay of " + engineering_text(sections.delay_s, "s") +
                     " is left out, poles and zeros do not make it");
  sections.delay_s = 0.0;
  return sections;
}

}  // namespace bodesmith::python
