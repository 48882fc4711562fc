// bode: responses of cascades, sections, plans, models and netlists.
#include <cmath>
#include <memory>

#include "base/error.hpp"
#include "chain/model_file.hpp"
#include "fpaa/plan/switched_board.hpp"
#include "functions.hpp"
#include "lti/bulk_response.hpp"
#include "lti/cascade.hpp"
#include "records.hpp"
#include "responses.hpp"
#include "schematic/ngspice/ngspice.hpp"

namespace bodesmith::python {
namespace {

std::vector<RadPerSecond> grid_of(const Call& call) {
  std::vector<RadPerSecond> out;
  for (const double f : call.array("frequency_hz")) {
    if (!(f > 0.0) || !std::isfinite(f)) throw InputError("frequency_hz holds a value that is not above 0");
    out.push_back(Hertz{f}.rad_s());
  }
  return out;
}

using Values = std::vector<std::complex<double>>;

template <class Response>
Values pointwise(const std::vector<RadPerSecond>& grid, Response response) {
  Values out;
  out.reserve(grid.size());
  for (const RadPerSecond w : grid) out.push_back(response(w));
  return out;
}

Values sections_response(const Sections& sections, const std::vector<RadPerSecond>& grid) {
  Values out(grid.size());
  BulkResponse(sections).responses(grid, out);
  return out;
}

ResponseFunction model_function(const Node& document) {
  auto model = std::make_shared<chain::Chain>(chain::model_from_node(document));
  for (std::size_t i = 0; i < model->blocks.size(); ++i) {
    if (!model->blocks[i].response(RadPerSecond{1.0})) {
      throw InputError("block " + std::to_string(i + 1) + " is a " +
                       std::string(model->blocks[i].type_name()) +
                       ", which has no frequency response (it is not linear)");
    }
  }
  return [model](RadPerSecond w) { return *model->response(w); };
}

ResponseFunction plan_function(const Node& document, bool with_delays) {
  auto plan = std::make_shared<fpaa::Plan>(fpaa::Plan::from_node(document));
  auto response = std::make_shared<fpaa::SwitchedBoard>(*plan);
  return [plan, response, with_delays](RadPerSecond w) {
    return with_delays ? response->gain(w) : response->sampled(w);
  };
}

}  // namespace

ResponseFunction response_function(const Node& document, bool with_delays) {
  const std::string schema = document.at("schema").string();
  if (schema == "bodesmith.cascade/1")
    return [cascade = Cascade::from_node(document)](RadPerSecond w) { return cascade.response(w); };
  if (schema == "bodesmith.sections/1")
    return [sections = Sections::from_node(document)](RadPerSecond w) { return sections.response(w); };
  if (schema == "bodesmith.fpaa_plan/1") return plan_function(document, with_delays);
  if (schema == "bodesmith.model/1") return model_function(document);
  document.at("schema").fail("is " + schema + ", which has no frequency response here");
}

Answer respond(const Call& call) {
  const Node document = call.options.at("of");
  const std::vector<RadPerSecond> grid = grid_of(call);
  const bool sections = document.at("schema").string() == "bodesmith.sections/1";
  Answer out;
  out.arrays["response"] = interleaved(
      sections ? sections_response(Sections::from_node(document), grid)
               : pointwise(grid, response_function(document, call.options.boolean_or("with_delays", true))));
  return out;
}

Answer respond_netlist(const Call& call) {
  const Node& o = call.options;
  std::vector<Hertz> grid;
  for (const RadPerSecond w : grid_of(call)) grid.push_back(w.hz());
  const std::string name = o.string_or("subcircuit", "");
  Values values;
  if (o.has("text")) {
    values = ngspice::run_ac_of_text(o.at("text").text(), o.string_or("name", "netlist"), grid, name);
  } else {
    const std::string path = o.at("path").string();
    const bool library = path.ends_with(".sub") || path.ends_with(".lib");
    values = library ? ngspice::run_ac_of_sub(path, grid, name) : ngspice::run_ac_of_deck(path, grid, name);
  }
  Answer out;
  out.arrays["response"] = interleaved(values);
  return out;
}

}  // namespace bodesmith::python
