#include "circuit_options.hpp"

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

Sections rational_part(Sections sections, std::vector<std::string>& warnings) {
  if (sections.delay_s == 0.0) return sections;
  warnings.push_back("the delay of " + engineering_text(sections.delay_s, "s") +
                     " is left out, poles and zeros do not make it");
  sections.delay_s = 0.0;
  return sections;
}

}  // namespace bodesmith::python
