#include "signal/time_record.hpp"
#include "reader.hpp"

namespace bodesmith::fuzz {
namespace {

void read_record_bytes(std::string_view bytes) {
  Provenance from;
  const TimeRecord record = TimeRecord::read_csv(as_file(bytes, "record.csv"), from);
  require_finite(record.step_s);
  require_finite(record.duration_s());
}
const Registered record_reader{"time_record", read_record_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
