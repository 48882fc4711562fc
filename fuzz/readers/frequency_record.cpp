#include "reader.hpp"
#include "signal/bode_points.hpp"

namespace bodesmith::fuzz {
namespace {

/// Files of other programs, told apart by content, among them.
void read_frequency_bytes(std::string_view bytes) {
  Provenance from;
  const FrequencyRecord record = FrequencyRecord::read_csv(as_file(bytes, "response.csv"), from);
  for (const Hertz f : record.frequency) require_finite(f.value);
  for (const auto& h : record.response) require_finite(h.real() + h.imag());
}
const Registered frequency_reader{"frequency_record", read_frequency_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
