#include "signal/frequency_record.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/whole_number.hpp"
#include "signal/columns.hpp"
#include "signal/csv.hpp"

namespace bodesmith {

FrequencyRecord FrequencyRecord::read_csv(const std::filesystem::path& path, Provenance& from) {
  const Csv csv = Csv::read(path, from, formats::Content::response);
  FrequencyRecord record;
  record.file = csv.file();
  const auto& frequency = csv.column(column::frequency_hz);
  const auto& magnitude = csv.column(column::magnitude_db);
  const auto& phase = csv.column(column::phase_deg);
  if (csv.has(column::coherence)) record.coherence = csv.column(column::coherence);
  for (std::size_t i = 0; i < csv.rows(); ++i) {
    if (!above_zero(frequency[i]))
      csv.fail(i, fmt::format("frequency_hz is {}, expected above {}", frequency[i],
                              frequency[i] > 0.0 ? "2.3e-308" : "0"));
    if (i > 0 && !(frequency[i] > frequency[i - 1])) csv.fail(i, "frequency_hz does not rise");
    if (!record.coherence.empty() && !(record.coherence[i] >= 0.0 && record.coherence[i] <= 1.0)) {
      csv.fail(i, fmt::format("coherence is {}, expected 0 to 1", record.coherence[i]));
    }
    const double gain = from_decibel(magnitude[i]);
    if (!std::isfinite(gain))
      csv.fail(i, fmt::format("magnitude_db is {}, expected at most 6000", magnitude[i]));
    record.frequency.push_back(Hertz{frequency[i]});
    record.response.push_back(std::polar(gain, to_radians(phase[i])));
  }
  return record;
}

}  // namespace bodesmith
