// controller.json and the sheet that goes with it.
#include <fmt/format.h>

#include "base/documents/json.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/controller/controller.hpp"
#include "fpaa/controller/io.hpp"

namespace bodesmith::fpaa {
namespace {

Json cam_json(const ControllerCam& cam) {
  Json out = {{"name", cam.name},     {"cam", cam.cam->name()},
              {"option", cam.option}, {"chip", cam.chip},
              {"cab", cam.cab},       {"clock_a_hz", cam.clock_a.value},
              {"phase", cam.phase},   {"delay_cycles", cam.delay_cycles},
              {"inputs", cam.inputs}, {"parameters", cam.requested.to_json()}};
  if (!cam.capacitors.empty()) {
    for (const Capacitor& c : cam.capacitors) out["capacitors"][c.name] = c.units;
  }
  if (cam.scheduled) {
    out["rate_gain"] = *cam.scheduled == Disturbance::Branch::ascending ? "ascending" : "descending";
  }
  return out;
}

const char* kind_text(OutsidePart::Kind kind) {
  static constexpr const char* kNames[] = {"reference", "constant", "AD835", "switch"};
  return kNames[static_cast<std::size_t>(kind)];
}

Json outside_json(const OutsidePart& part) {
  Json out = {{"name", part.name}, {"kind", kind_text(part.kind)}, {"inputs", part.inputs}};
  if (part.kind == OutsidePart::Kind::constant) out["value_v"] = part.value;
  if (part.kind == OutsidePart::Kind::multiplier) out["scale_per_v"] = part.value;
  return out;
}

Json variant_json(const ControllerVariant& v) {
  Json item = {{"polynomial", to_string(v.by)},
               {"structure", to_string(v.structure)},
               {"fits", v.fits()},
               {"contraction", v.contraction},
               {"max_error_percent", v.max_error_percent},
               {"rms_error_percent", v.rms_error_percent},
               {"bandwidth_hz", v.bandwidth_hz},
               {"delay_s", v.delay_s},
               {"outside_multipliers", v.outside_multipliers()},
               {"chips", v.chips},
               {"cams", v.cams.size()},
               {"opamps", v.resources.opamps},
               {"capacitors", v.resources.capacitors},
               {"comparators", v.resources.comparators},
               {"lookup_tables", v.resources.lookup_tables},
               {"io_cells", v.io_cells}};
  if (v.refusal) item["why_not"] = v.refusal->reason;
  return item;
}

}  // namespace

Json Controller::to_json() const {
  Json out;
  out["chosen"] = to_string(best().by);
  out["structure"] = to_string(best().structure);
  out["equation"] = equation(best().structure);
  out["volts_per_stroke_v"] = best().scale.volts_per_stroke;
  out["stroke_at_0_v"] = best().scale.centre;
  out["why"] = why;
  // One a way of making the polynomials, in the structure that was chosen; then every structure.
  out["variants"] = Json::array();
  out["structures"] = Json::array();
  for (const ControllerVariant& v : variants) {
    if (v.structure == best().structure) out["variants"].push_back(variant_json(v));
    out["structures"].push_back(variant_json(v));
  }
  out["cams"] = Json::array();
  for (const ControllerCam& cam : best().cams) out["cams"].push_back(cam_json(cam));
  out["outside"] = Json::array();
  for (const OutsidePart& part : best().outside) out["outside"].push_back(outside_json(part));
  out["wires"] = Json::array();
  for (const Wire& wire : controller_plan(best()).wires)
    out["wires"].push_back({{"from", wire.from}, {"to", wire.to}, {"input", wire.input}});
  out["assumptions"] = assumptions;
  return out;
}

std::string controller_sheet(const Controller& controller) {
  Json data = controller.to_json();
  for (Json& v : data["variants"]) {
    for (const char* key : {"max_error_percent", "rms_error_percent", "bandwidth_hz"}) {
      v[key] = rounded_text(v[key].get<double>(), 3);
    }
    v["delay_us"] = rounded_text(1e6 * v["delay_s"].get<double>(), 4);
  }
  for (Json& cam : data["cams"]) {
    std::vector<std::string> parts;
    for (const auto& [key, value] : cam["parameters"].items()) {
      if (value.is_number())
        parts.push_back(fmt::format("{} = {}", key, rounded_text(value.get<double>(), 6)));
    }
    cam["settings"] = join(parts, ", ");
    std::vector<std::string> from;
    for (const Json& input : cam["inputs"]) from.push_back(input.get<std::string>());
    cam["from"] = join(from, ", ");
    cam["clock"] = rounded_text(cam["clock_a_hz"].get<double>() / 1e3, 6);
  }
  return render_template("fpaa/controller.md", data);
}

}  // namespace bodesmith::fpaa
