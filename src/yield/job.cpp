#include "yield/job.hpp"

#include <fmt/format.h>

#include "base/text.hpp"

namespace bodesmith::yield {

std::string job_text(const Options& options, const Provenance& from) {
  const Spread& s = options.spread;
  std::string text = fmt::format("{} {} {} {} {} {} {} {} {} {} {} {}", static_cast<int>(s.kind), s.sigmas,
                                 s.resistor_percent, s.capacitor_percent, s.mismatch.unit_percent,
                                 s.mismatch.systematic_units, s.temperature_low_c, s.temperature_high_c,
                                 s.resistor_ppm_per_k, s.capacitor_ppm_per_k, options.limit_db.value_or(-1.0),
                                 options.limit_deg.value_or(-1.0));
  for (const Hertz f : options.grid) text += " " + number_text(f.value);
  for (const InputFile& file : from.inputs) text += " " + file.sha256;
  return text;
}

}  // namespace bodesmith::yield
