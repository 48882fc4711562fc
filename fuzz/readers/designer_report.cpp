#include "fpaa/sheets/report_check.hpp"
#include "reader.hpp"

namespace bodesmith::fuzz {
namespace {

void read_designer_report_bytes(std::string_view bytes) {
  fpaa::read_report(bytes, "report.html");
}
const Registered designer_report_reader{"designer_report", read_designer_report_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
