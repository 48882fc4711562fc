#include <fmt/format.h>

#include "base/error.hpp"
#include "base/text.hpp"
#include "exchange/writer.hpp"

namespace bodesmith::exchange {

BODESMITH_REGISTRY(Writer, writers, "export format", touchstone_writer, frd_writer, csv_writer, pwl_writer,
                   spice_source_writer, matlab_writer, python_writer, octave_writer, c_writer, verilog_writer,
                   ltspice_writer)

const Writer& writer_for(std::string_view file_name) {
  std::string known;
  for (const Writer* writer : writers().all()) {
    for (const std::string_view ending : split(writer->endings(), ' ')) {
      if (file_name.size() > ending.size() && file_name.ends_with(ending)) return *writer;
      known += (known.empty() ? "" : ", ") + std::string(ending);
    }
  }
  throw InputError(
      fmt::format("'{}' has no ending of a format that is written, expected one of {} (or the format's name)",
                  file_name, known));
}

namespace {

[[noreturn]] void lacks(const Exportable& from, const Writer& writer, std::string_view needed) {
  const std::string_view has = from.record ? "a time record" : from.sections ? "sections" : "a response";
  throw InputError(from.source, 0, fmt::format("is {}, but {} needs {}", has, writer.name(), needed));
}

}  // namespace

const Sections& need_sections(const Exportable& from, const Writer& writer) {
  if (!from.sections) lacks(from, writer, "pole-zero sections (a measured response becomes them by a fit)");
  return *from.sections;
}
const schematic::Netlist& need_circuit(const Exportable& from, const Writer& writer) {
  if (!from.circuit) lacks(from, writer, "a circuit.json (of spice or run)");
  return *from.circuit;
}
const FrequencyRecord& need_response(const Exportable& from, const Writer& writer) {
  if (!from.response) lacks(from, writer, "a complex frequency response");
  return *from.response;
}
const TimeRecord& need_record(const Exportable& from, const Writer& writer) {
  if (!from.record) lacks(from, writer, "a time record");
  return *from.record;
}

std::string identifier(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    out += plain ? c : '_';
  }
  if (out.empty() || (out[0] >= '0' && out[0] <= '9')) out = "f_" + out;
  return out;
}

}  // namespace bodesmith::exchange
