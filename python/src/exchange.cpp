// export: designs, responses and records for other programs.
#include "base/files.hpp"
#include "exchange/writer.hpp"
#include "functions.hpp"
#include "records.hpp"

namespace bodesmith::python {
namespace {

exchange::ExportOptions export_options(const Node& o) {
  using exchange::Discretisation;
  exchange::ExportOptions out;
  out.discretise.sample_hz = maybe_positive(o, "sample_hz").value_or(0.0);
  out.discretise.method = choice(o, "method", {Discretisation::tustin, Discretisation::matched});
  if (const auto f = maybe_positive(o, "prewarp_hz")) out.discretise.prewarp = Hertz{*f};
  out.discretise.single_precision = o.boolean_or("single_precision", false);
  out.output_signal = o.has("signal") && o.at("signal").one_of({"u", "y"}) == "y";
  return out;
}

}  // namespace

Answer export_to(const Call& call) {
  const Node& o = call.options;
  o.allow_only({"path", "format", "name", "sections", "record", "sample_hz", "method", "prewarp_hz",
                "single_precision", "signal"});
  const std::string path = o.at("path").string();
  const exchange::Writer& writer =
      o.has("format") ? exchange::writers().get(o.at("format").string()) : exchange::writer_for(path);
  exchange::Exportable from;
  from.source = o.string_or("name", "bodesmith");
  from.name = exchange::identifier(from.source);
  if (o.has("sections")) from.sections = Sections::from_node(o.at("sections"));
  if (call.has_array("frequency_hz")) from.response = response_of(call);
  if (o.has("record")) from.record = record_of(call, o.at("record"));
  const exchange::Written written = writer.write(from, export_options(o));
  write_file(path, written.content);
  Answer out;
  out.result = {{"format", std::string(writer.name())}, {"said", written.said}};
  return out;
}

}  // namespace bodesmith::python
