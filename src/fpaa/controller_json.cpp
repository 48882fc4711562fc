// controller.json and the sheet that goes with it.
#include <fmt/format.h>

#include "base/json.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/controller.hpp"

namespace bodesmith::fpaa {
Json Controller::to_json() const {
  Json out;
  out["chosen"] = to_string(best().by);
  out["why"] = why;
  out["variants"] = Json::array();
  for (const ControllerVariant& v : variants) {
    Json item = {{"polynomial", to_string(v.by)},
                 {"fits", v.fits()},
                 {"max_error_percent", v.max_error_percent},
                 {"rms_error_percent", v.rms_error_percent},
                 {"bandwidth_hz", v.bandwidth_hz},
                 {"delay_s", v.delay_s},
                 {"outside_multipliers", v.outside_multipliers},
                 {"chips", v.chips},
                 {"cams", v.cams.size()},
                 {"opamps", v.resources.opamps},
                 {"capacitors", v.resources.capacitors},
                 {"comparators", v.resources.comparators},
                 {"lookup_tables", v.resources.lookup_tables},
                 {"io_cells", v.io_cells}};
    if (v.refusal) item["why_not"] = v.refusal->reason;
    out["variants"].push_back(item);
  }
  out["cams"] = Json::array();
  for (const ControllerCam& cam : best().cams) {
    out["cams"].push_back({{"name", cam.name},
                           {"cam", cam.cam->name()},
                           {"option", cam.option},
                           {"chip", cam.chip},
                           {"cab", cam.cab},
                           {"clock_a_hz", cam.clock_a.value},
                           {"phase", cam.phase},
                           {"delay_cycles", cam.delay_cycles},
                           {"inputs", cam.inputs},
                           {"parameters", cam.parameters.to_json()}});
  }
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
