#include "signal/csv.hpp"
#include "reader.hpp"

namespace bodesmith::fuzz {
namespace {

void read_csv_bytes(std::string_view bytes) {
  const Csv csv = Csv::parse(bytes, "input.csv");
  for (const std::string& name : csv.names()) {
    for (const double value : csv.column(name)) require_finite(value);
  }
}
const Registered csv_reader{"csv", read_csv_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
