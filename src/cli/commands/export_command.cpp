#include <fmt/format.h>

#include <algorithm>
#include <variant>

#include "base/documents/document.hpp"
#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "chain/kernel.hpp"
#include "chain/model_file.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "cli/response_source.hpp"
#include "cli/shared_options.hpp"
#include "exchange/writer.hpp"
#include "fpaa/plan/plan.hpp"
#include "project/output/plan_model.hpp"
#include "signal/bode_points.hpp"
#include "signal/columns.hpp"
#include "signal/csv.hpp"
#include "synthesis/circuit_file.hpp"

namespace bodesmith::cli {
namespace {

std::vector<Hertz> export_grid(const CommandLine& line, const ResponseSource& source) {
  Band band = source.band ? Band{Hertz{source.band->from.value / 10.0}, Hertz{source.band->to.value * 10.0}}
                          : Band{Hertz{1.0}, Hertz{1e5}};
  if (const auto asked = line.maybe_band()) band = *asked;
  return log_grid(band, line.integer("count", 2, 1'000'000));
}

/// With its phase, or nothing.
std::optional<FrequencyRecord> measured_response(const std::filesystem::path& path, Provenance& from) {
  const BodePoints points = BodePoints::read_csv(path, from);
  FrequencyRecord out;
  out.file = points.file;
  for (const BodePoint& point : points.points) {
    if (!point.phase_deg) return std::nullopt;
    out.frequency.push_back(point.frequency);
    out.response.push_back(std::polar(point.gain, to_radians(*point.phase_deg)));
  }
  return out;
}

/// The blocks of a model.toml, or of a plan.json as a model, for scripts. Of a block that is itself an approximation (a fractional term),
/// what its engine runs.
void add_chain(const std::string& file, exchange::Exportable& out) {
  Provenance again;
  const Node node = read_document(file, again);
  const std::string schema = node.string_or("schema", "");
  std::vector<chain::Block> blocks;
  if (schema == "bodesmith.model/1") blocks = chain::model_from_node(node).blocks;
  if (schema == "bodesmith.fpaa_plan/1") blocks = project::plan_model(fpaa::Plan::from_node(node)).blocks;
  for (const chain::Block& block : blocks) {
    const chain::Kernel kernel = block.kernel();
    const auto* linear = std::get_if<chain::LinearKernel>(&kernel);
    if (linear == nullptr) {
      out.chain.clear();
      return;
    }
    out.chain.push_back({block.type_name(), *linear, linear->delay_s});
  }
}

/// A circuit.json: its parts as they are mounted, and their response with ideal op-amps.
exchange::Exportable load_circuit(const CommandLine& line, const std::string& file, Provenance& from) {
  const synthesis::CircuitFile made = synthesis::CircuitFile::from_node(read_document(file, from));
  exchange::Exportable out;
  out.source = file;
  out.name = exchange::identifier(std::filesystem::path(file).stem().string());
  out.circuit = made.circuit;
  out.circuit_band = made.band;
  FrequencyRecord record;
  record.file = file;
  ResponseSource source;
  source.band = made.band;
  record.frequency = export_grid(line, source);
  for (const Hertz f : record.frequency) record.response.push_back(made.circuit.response(f.rad_s()));
  out.response = std::move(record);
  return out;
}

bool is_circuit(const std::string& file) {
  Provenance aside;
  if (!is_own_document(file)) return false;
  const Node node = read_document(file, aside);
  return node.kind() == Node::Kind::object && node.string_or("schema", "") == "bodesmith.circuit/1";
}

exchange::Exportable load_exportable(const CommandLine& line, const std::string& file,
                                     const exchange::Writer& writer, Provenance& from) {
  if (is_circuit(file)) return load_circuit(line, file, from);
  exchange::Exportable out;
  out.source = file;
  if (is_design(file)) {
    const bool runs = as_it_runs(line);
    if (writer.rebuilds_chains() && !runs)
      line.fail("--without-holds is for responses; what is rebuilt of a plan is the board as it runs");
    const ResponseSource source = load_response(file, {runs, ""}, from);
    out.sections = source.sections;
    FrequencyRecord record;
    record.file = file;
    record.frequency = export_grid(line, source);
    record.response = source.response(record.frequency);
    out.response = std::move(record);
    out.name = exchange::identifier(source.stem);
    if (writer.rebuilds_chains() && is_own_document(file)) add_chain(file, out);
    return out;
  }
  for (const char* option : {"from-hz", "to-hz", "count"}) {
    if (line.has(option)) line.fail(fmt::format("--{} is for designs; {} has its own points", option, file));
  }
  Provenance aside = from;
  const Csv csv = Csv::read(file, aside);
  if (csv.has(column::time_s) || (from.sample_hz && csv.has(column::input))) {
    out.record = TimeRecord::read_csv(file, from);
  } else {
    out.response = measured_response(file, from);
    if (!out.response)
      throw InputError(csv.file(), 0, "has no phase, expected a complex response or a time record");
  }
  out.name = exchange::identifier(std::filesystem::path(csv.file()).stem().string());
  return out;
}

std::string writers_text() {
  std::string out = "Formats, by the ending of -o or --as:\n";
  for (const exchange::Writer* writer : exchange::writers().all())
    out += fmt::format("  {:<15}{:<11}{}\n", writer->name(), writer->endings(), writer->what());
  return out;
}

exchange::ExportOptions read_export_options(const CommandLine& line) {
  using exchange::Discretisation;
  exchange::ExportOptions out;
  out.discretise.sample_hz = line.maybe_positive("sample-hz").value_or(0.0);
  out.discretise.method = line.choice("method", {Discretisation::tustin, Discretisation::matched});
  if (const auto f = line.maybe_positive("prewarp-hz")) out.discretise.prewarp = Hertz{*f};
  out.discretise.single_precision = line.has("float");
  out.bits = static_cast<int>(line.integer("bits", 4, 53));
  out.multipliers = static_cast<int>(line.integer("multipliers", 1, 100'000));
  out.clock_hz = line.positive("fpga-clock-hz");
  const std::string signal = line.get<std::string>("signal");
  if (signal != "u" && signal != "y") line.fail(fmt::format("--signal is '{}', expected u or y", signal));
  out.output_signal = signal == "y";
  return out;
}

}  // namespace

int run_export(const std::vector<std::string>& arguments) {
  CommandLine line(
      "export", "bodesmith export sections.json --sample-hz 48000 -o filter.c",
      "Writes a design, a response or a record for other programs:\n"
      "  bodesmith export sections.json -o sections.py      (python-control; .m: Octave; .mat: MATLAB)\n"
      "  bodesmith export plan.json -o plan.m               (plans, as they run, and linear models too: .py, .m)\n"
      "  bodesmith export plan.json -o plan.s2p             (.frd, .csv)\n"
      "  bodesmith export circuit.json -o circuit.asc       (LTspice)\n"
      "  bodesmith export drive.csv --signal u -o drive.pwl (LTspice; .inc: a source for any SPICE)\n"
      "  bodesmith export run.raw:v(out) -o response.csv    (any format that is read, to own CSV)\n" +
          writers_text());
  line.positional("FILE", 1, 1);
  line.option<std::string>("as", "format by its name (default: by the ending of -o)");
  line.words("as", exchange::writers().name_list());
  line.band("lowest frequency of a design's response (default: a decade below its corners)",
            "highest frequency");
  line.option<int>("count", "number of frequencies of a design's response", 200);
  add_hold_options(line);
  line.option<std::string>("signal", "of a record, where one is written: u or y", "u");
  line.words("signal", {"u", "y"});
  line.option<double>("sample-hz", "sampling rate of digital biquads, or of a record without times");
  line.option<std::string>("method", "tustin or matched", "tustin");
  line.words("method", {"tustin", "matched"});
  line.option<double>("prewarp-hz", "tustin: exact here (default: every section at its own corner)");
  line.flag("float", "digital biquads in single precision");
  line.option<int>("bits", "bits of a fixed-point coefficient (verilog-biquads)", 18);
  line.option<int>("multipliers",
                   "multipliers of the FPGA, one product per clock cycle each (verilog-biquads)", 1);
  line.option<double>("fpga-clock-hz", "clock of the FPGA (verilog-biquads)", 40e6);
  line.output("file to write");
  line.reads_measurements();
  if (!line.parse(arguments)) return kDone;

  Provenance from = line.new_provenance();
  const exchange::Writer& writer = line.has("as") ? exchange::writers().get(line.get<std::string>("as"))
                                                  : exchange::writer_for(line.output_path().string());
  const exchange::ExportOptions options = read_export_options(line);
  const exchange::Exportable source = load_exportable(line, line.files().front(), writer, from);
  const Stopwatch watch;
  const exchange::Written written = writer.write(source, options);
  const double seconds = watch.seconds();
  write_file(line.output_path(), written.content);
  std::string text = fmt::format("{}: {}\n", line.output_path().string(), writer.what());
  for (const std::string& said : written.said) text += "  " + said + "\n";
  const Json summary = {{"format", std::string(writer.name())}, {"said", written.said}};
  return print_summary(line, text, timed_document("export_summary", from, summary, seconds));
}

}  // namespace bodesmith::cli
