#include "base/json.hpp"
#include "circuit/json.hpp"
#include "kicad/schematic.hpp"
#include "project/artefacts.hpp"
#include "project/filter_page.hpp"
#include "project/run_files.hpp"
#include "spice/emit.hpp"
#include "yield/json.hpp"

namespace bodesmith::project {
namespace {

constexpr int kTableRows = 241;

std::string document(std::string_view schema, const FilterRun& run, const Json& body) {
  return artefact_json(schema, run.from, body, run.design.compute_s);
}

std::string bode_table(const FilterRun& run) {
  const Band& band = run.project.band;
  ResponseTable table(log_grid({Hertz{band.from.value / 2.0}, Hertz{band.to.value * 2.0}}, kTableRows));
  for (const FilterStage& stage : filter_stages(run.design)) table.add(stage.name, stage.response);
  return table.text();
}

void add_circuit_files(const FilterRun& run, OutputSet& out) {
  const circuit::Candidate& best = run.design.circuit->best;
  OutputSet spice;
  spice::add_spice_files(best.made, run.project.name, spice);
  kicad::add_kicad_files(best.made.circuit, run.project.name, spice);
  out.include("spice", spice);
  Json json = circuit::to_json(best.made);
  json["judged"] = circuit::to_json(best.judged);
  json["judged"]["band_hz"] = {best.judged_band.from.value, best.judged_band.to.value};
  json["shortfalls"] = best.shortfalls;
  out.add("spice/circuit.json", document("circuit", run, json));
}

Json tolerances_json(const FilterRun& run) {
  yield::Options options;
  options.limit_db = run.project.limits.yield_db;
  return yield::to_json(*run.design.yield, options);
}

}  // namespace

OutputSet filter_files(const FilterRun& run, const std::filesystem::path& folder) {
  OutputSet out(folder);
  if (run.design.fit) out.add("cascade.json", document("cascade", run, run.design.fit->to_json()));
  Json sections = run.design.sections.to_json();
  if (run.design.direct) sections["fit"] = run.design.direct->report_json();
  if (run.design.approximation) sections["approximation"] = run.design.approximation->report_json();
  out.add("sections.json", document("sections", run, sections));
  if (const auto& plan = run.design.plan)
    add_board_files(*plan, document("fpaa_plan", run, plan->to_json()), out);
  if (run.design.circuit) add_circuit_files(run, out);
  if (run.design.yield)
    out.add("yield.json", document("yield", run, {{"designs", Json::array({tolerances_json(run)})}}));
  out.add("bode.csv", bode_table(run));
  out.add("bode.svg", filter_svg(run));
  out.add("report.html", filter_page(run));
  return out;
}

}  // namespace bodesmith::project
