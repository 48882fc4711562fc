#include <fmt/format.h>

#include "base/text.hpp"
#include "project/report_tables.hpp"
#include "project/run.hpp"
#include "report/page.hpp"

namespace bodesmith::project {
namespace {

std::string ngspice_sentence(const spice::CompensatorCheck& check) {
  return fmt::format(
      "ngspice on the emitted netlist, {} to {} Hz: {} dB from the program's own network solution, "
      "{} dB and {} degrees from the sections.",
      rounded_text(check.band.from.value), rounded_text(check.band.to.value),
      rounded_text(check.against_network.max_magnitude_db, 3),
      rounded_text(check.against_sections.max_magnitude_db, 3),
      rounded_text(check.against_sections.max_phase_deg, 3));
}

}  // namespace

void circuit_chapter(report::Page& page, const ProjectRun& run) {
  if (!run.design.circuit) return;
  const circuit::Realised& realised = run.design.realised();
  const circuit::RealiseReport& report = realised.report;
  page.chapter("Circuit");
  page.paragraph(fmt::format(
      "{} op-amp stages, {} parts ({} resistors, {} capacitors). Error against the sections between {} and {} Hz: {} "
      "dB from the preferred values ({} dB if each were rounded by itself), {} dB from the op-amps ({}).",
      realised.circuit.stages.size(), realised.circuit.parts.size(), run.project.circuit->resistors,
      run.project.circuit->capacitors, rounded_text(report.band.from.value),
      rounded_text(report.band.to.value), rounded_text(report.parts.max_magnitude_db, 3),
      rounded_text(report.nearest.max_magnitude_db, 3), rounded_text(report.opamps.max_magnitude_db, 3),
      realised.circuit.opamp.name));
  if (run.ngspice) {
    page.paragraph(ngspice_sentence(*run.ngspice));
  } else {
    page.warning("ngspice is not installed: the netlist was not simulated.");
  }
  page.table(parts_table(realised.circuit.parts));
  for (const std::string& warning : report.warnings) page.warning(warning);
}

}  // namespace bodesmith::project
