// fpaa, spice, layout: sections and disturbances as hardware.
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "circuit_options.hpp"
#include "fpaa/plan/error_budget.hpp"
#include "fpaa/plan/plan.hpp"
#include "fpaa/sheets/board_netlist.hpp"
#include "fpaa/sheets/board_picture.hpp"
#include "fpaa/sheets/build_sheet.hpp"
#include "functions.hpp"
#include "schematic/ngspice/ngspice.hpp"
#include "schematic/opamp_library.hpp"
#include "synthesis/circuit_file.hpp"
#include "synthesis/decks/compensator_files.hpp"
#include "synthesis/generator/budget.hpp"
#include "synthesis/generator/circuit.hpp"
#include "synthesis/generator/files.hpp"
#include "synthesis/generator/ngspice_check.hpp"
#include "synthesis/generator/timing.hpp"
#include "synthesis/realisation.hpp"
#include "synthesis/realise_search.hpp"

namespace bodesmith::python {
namespace {

fpaa::PlanOptions plan_options(const Node& o) {
  using Topology = fpaa::PlanOptions::Topology;
  fpaa::PlanOptions out;
  out.board = o.string_or("board", out.board);
  out.topology = choice(o, "topology", {Topology::automatic, Topology::chain, Topology::bilinear});
  if (const auto clock = maybe_positive(o, "clock_hz")) out.clock = Hertz{*clock};
  if (const auto clock = maybe_positive(o, "min_clock_hz")) out.lowest_clock = Hertz{*clock};
  out.band = maybe_band(o);
  out.assumptions.mismatch = fpaa::MismatchModel::from_node(o, {});
  out.assumptions.noise.unit_capacitance_f =
      positive_or(o, "unit_capacitance_f", out.assumptions.noise.unit_capacitance_f);
  out.assumptions.slow =
      fpaa::SlowParts::given(maybe_positive(o, "opamp_bandwidth_hz"),
                             positive_or(o, "opamp_gain", fpaa::SlowParts::typical().opamp.dc_gain),
                             maybe_positive(o, "switch_ohm"), out.assumptions.noise.unit_capacitance_f);
  out.assumptions.seed = seed_of(o);
  return out;
}

void require_ngspice(const Node& options) {
  if (options.boolean_or("check", false) && !ngspice::is_available())
    throw InputError("check needs ngspice, which is not installed (Debian: apt-get install ngspice)");
}

generator::Options layout_options(const Node& o) {
  generator::Options out;
  out.resistors = synthesis::Series::named(o.string_or("series", "E96"));
  out.scheme = generator::Scheme::named(o.string_or("scheme", "auto"));
  out.multiplier.scale_v = positive_or(o, "multiplier_scale_v", out.multiplier.scale_v);
  out.full_scale_v = positive_or(o, "full_scale_v", out.full_scale_v);
  out.lowest = Hertz{positive_or(o, "lowest_hz", out.lowest.value)};
  out.highest = Hertz{positive_or(o, "highest_hz", out.highest.value)};
  return out;
}

}  // namespace

Answer plan_board(const Call& call) {
  const Node& o = call.options;
  o.allow_only({"sections", "board", "topology", "clock_hz", "min_clock_hz", "band_hz",
                "unit_capacitor_percent", "systematic_units", "unit_capacitance_f", "opamp_bandwidth_hz",
                "opamp_gain", "switch_ohm", "netlist", "seed"});
  Answer out;
  const Sections sections = rational_part(Sections::from_node(o.at("sections")), out.warnings);
  const fpaa::PlanOptions options = plan_options(o);
  const Stopwatch watch;
  const fpaa::Plan plan = value_or_throw(fpaa::make_plan(sections, options));
  const double seconds = watch.seconds();
  Json body = plan.to_json();
  body["budget"] = fpaa::error_budget(plan, sections, options.assumptions).to_json();
  out.result = document("fpaa_plan", body, seconds);
  out.files["build_sheet.md"] = fpaa::build_sheet_markdown(plan);
  out.files["build_sheet.html"] = fpaa::build_sheet_html(plan);
  out.files["board.svg"] = fpaa::board_picture_svg(plan);
  if (o.boolean_or("netlist", false)) {
    fpaa::NetlistParts parts;
    parts.unit_capacitance_f = options.assumptions.noise.unit_capacitance_f;
    out.files["board.sub"] = fpaa::board_netlist(plan, parts, "FPAA plan");
    out.files["board.cir"] = fpaa::board_deck(plan, "FPAA plan");
  }
  return out;
}

Answer realise_circuit(const Call& call) {
  const Node& o = call.options;
  o.allow_only({"sections", "realization", "series", "capacitor_series", "min_ohm", "max_ohm", "min_f",
                "max_f", "isolation_ohm", "opamp", "amplitude_v", "band_hz", "check"});
  require_ngspice(o);
  Answer out;
  const Sections sections = rational_part(Sections::from_node(o.at("sections")), out.warnings);
  synthesis::RealiseOptions options = circuit_options(o);
  options.limits = synthesis::realisation_registry().get(options.realisation).usual_limits();
  options.limits.min_ohm = positive_or(o, "min_ohm", options.limits.min_ohm);
  options.limits.max_ohm = positive_or(o, "max_ohm", options.limits.max_ohm);
  options.limits.min_f = positive_or(o, "min_f", options.limits.min_f);
  options.limits.max_f = positive_or(o, "max_f", options.limits.max_f);
  if (o.has("isolation_ohm")) options.isolation_ohm = o.at("isolation_ohm").non_negative();
  options.band = maybe_band(o);
  const double amplitude_v = positive_or(o, "amplitude_v", 1.0);
  const auto library = schematic::OpAmpLibrary::built_in();
  const std::string opamp = o.string_or("opamp", "generic-10M");
  if (opamp != "auto") options.opamp = library.named(opamp);
  const Stopwatch watch;
  synthesis::BuildSearch search{
      .options = options, .limits = {}, .limits_given = true, .amplitude_v = amplitude_v};
  if (opamp == "auto") search.opamps = &library;
  const synthesis::Candidate built = value_or_throw(realise_for_building(sections, search)).best;
  const synthesis::Realised& made = built.made;
  const synthesis::OpAmpCheck& opamps = built.opamps;
  Json body = to_json(made);
  body["judged"] = synthesis::judged_json(made.report.all, made.report.band);
  body["opamp_check"] = to_json(opamps);
  const double seconds = watch.seconds();
  if (o.boolean_or("check", false))
    body["ngspice"] = to_json(synthesis::check_compensator(made.circuit, sections));
  out.result = document("circuit", body, seconds);
  out.warnings.insert(out.warnings.end(), opamps.warnings.begin(), opamps.warnings.end());
  OutputSet files;
  synthesis::add_compensator_files(made, "compensator", files);
  for (const auto& path : files.paths()) out.files[path.string()] = *files.content(path);
  return out;
}

Answer lay_out(const Call& call) {
  const Node& o = call.options;
  o.allow_only({"disturbance", "series", "scheme", "multiplier_scale_v", "full_scale_v", "lowest_hz",
                "highest_hz", "check"});
  require_ngspice(o);
  const generator::Input input = generator::Input::from_node(o.at("disturbance"));
  const generator::Options options = layout_options(o);
  const Stopwatch watch;
  const generator::DisturbanceCircuit layout = generator::make_layout(input, options);
  const generator::Budget budget = generator::make_budget(layout);
  const generator::Timing timing =
      generator::make_timing(layout, {options.lowest, Hertz{100}, options.highest});
  const double seconds = watch.seconds();
  Json body = to_json(layout, budget, timing);
  if (o.boolean_or("check", false))
    body["ngspice"] = to_json(generator::check_disturbance(layout, {Hertz{100}, options.highest}));
  Answer out;
  out.result = document("layout", body, seconds);
  out.warnings = layout.warnings;
  OutputSet files;
  generator::add_layout_files(layout, "disturbance generator", body, files);
  for (const auto& path : files.paths()) {
    if (path != "layout.json") out.files[path.string()] = *files.content(path);
  }
  return out;
}

}  // namespace bodesmith::python
