// yield: what tolerances do to designs.
#include "tolerance/yield.hpp"

#include <algorithm>

#include "base/progress.hpp"
#include "circuit_options.hpp"
#include "functions.hpp"
#include "lti/frequency_grid.hpp"
#include "tolerance/design.hpp"

namespace bodesmith::python {
namespace {

tolerance::Spread spread_of(const Node& o, const tolerance::Design& design) {
  using Drawn = tolerance::Spread::Kind;
  tolerance::Spread out(design);
  out.kind = choice(o, "distribution", {Drawn::uniform, Drawn::gaussian, Drawn::corners});
  out.sigmas = positive_or(o, "sigmas", out.sigmas);
  out.resistor_percent = o.number_or("resistor_percent", out.resistor_percent);
  out.capacitor_percent = o.number_or("capacitor_percent", out.capacitor_percent);
  out.mismatch = fpaa::MismatchModel::from_node(o, out.mismatch);
  if (o.has("temperature_c")) {
    const std::vector<double> range = o.at("temperature_c").numbers();
    if (range.size() != 2) o.at("temperature_c").fail("has not two values, expected (low, high)");
    out.temperature_low_c = range[0];
    out.temperature_high_c = range[1];
  }
  out.resistor_ppm_per_k = o.number_or("resistor_ppm", out.resistor_ppm_per_k);
  out.capacitor_ppm_per_k = o.number_or("capacitor_ppm", out.capacitor_ppm_per_k);
  return out;
}

tolerance::Design design_of(const Node& document, const std::string& name, const Node& o, Answer& out) {
  if (document.at("schema").string() == "bodesmith.fpaa_plan/1") {
    std::optional<Sections> wanted;
    if (o.has("sections")) wanted = Sections::from_node(o.at("sections"));
    return tolerance::design_of_plan(document, name, wanted);
  }
  if (document.at("schema").string() == "bodesmith.circuit/1")
    return tolerance::design_of_file(document, name, tolerance::OpAmps::as_built);
  const Sections sections = rational_part(Sections::from_node(document), out.warnings);
  synthesis::RealiseOptions options = circuit_options(o);
  if (!o.has("capacitor_series")) options.capacitors = synthesis::Series::named("E12");
  return tolerance::design_of_circuit(
      synthesis::realise(sections, options).circuit, sections, name,
      o.has("opamp") ? tolerance::OpAmps::as_built : tolerance::OpAmps::ideal);
}

}  // namespace

Answer yield_of(const Call& call) {
  const Node& o = call.options;
  o.allow_only({"designs",
                "names",
                "sections",
                "samples",
                "seed",
                "threads",
                "distribution",
                "sigmas",
                "resistor_percent",
                "capacitor_percent",
                "unit_capacitor_percent",
                "systematic_units",
                "temperature_c",
                "resistor_ppm",
                "capacitor_ppm",
                "limit_db",
                "limit_deg",
                "realization",
                "series",
                "capacitor_series",
                "count",
                "band_hz"});
  tolerance::Options options;
  options.samples =
      static_cast<std::uint64_t>(o.has("samples") ? o.at("samples").integer(1, 1'000'000'000'000) : 100'000);
  options.seed = seed_of(o);
  options.threads = integer_or(o, "threads", 0, 0, 1024);
  options.limit_db = maybe_positive(o, "limit_db");
  options.limit_deg = maybe_positive(o, "limit_deg");

  Answer out;
  const std::vector<Node> documents = o.at("designs").items();
  if (documents.empty()) o.at("designs").fail("is empty, expected at least one design");
  std::vector<tolerance::Design> designs;
  for (std::size_t i = 0; i < documents.size(); ++i)
    designs.push_back(design_of(documents[i], o.at("names")[i].string(), o, out));
  const Band band = maybe_band(o).value_or(designs[0].band);
  const bool counted = o.has("count") && o.at("count").kind() != Node::Kind::null;
  const int count = band.from == band.to ? 1 : counted ? integer_or(o, "count", 60, 2, 100'000) : 60;
  options.grid = counted || count == 1 ? log_grid(band, count) : judging_grid(designs[0].wanted, band, count);
  tolerance::leave_out_nulls(designs, options.grid);

  const Stopwatch watch;
  options.spread = spread_of(o, designs[0]);
  Json body = {{"distribution", to_string(options.spread.kind)},
               {"seed", options.seed},
               {"resistor_percent", options.spread.resistor_percent},
               {"capacitor_percent", options.spread.capacitor_percent},
               {"unit_capacitor_percent", options.spread.mismatch.unit_percent},
               {"designs", Json::array()}};
  const Team alone;
  for (const tolerance::Design& design : designs) {
    Progress progress("yield of " + design.name);
    options.spread = spread_of(o, design);
    options.progress = [&progress](double fraction) { progress.at(fraction); };
    const tolerance::Result result = tolerance::run_monte_carlo(design, options, alone);
    Json one = to_json(result, options);
    one["poles"] = design.poles;
    one["parts"] = design.parts.size();
    one["reference"] = design.reference_name;
    if (options.limit_db && design.reference_name == "sections") {
      options.progress = nullptr;
      one["to_buy"] = tolerance::to_json(tolerance::tolerances_to_buy(design, options, *options.limit_db));
    }
    body["designs"].push_back(std::move(one));
    out.warnings.insert(out.warnings.end(), design.notes.begin(), design.notes.end());
  }
  out.result = document("yield", body, watch.seconds());
  return out;
}

}  // namespace bodesmith::python
