#include "fpaa/sheets/zrna_script.hpp"

#include "base/documents/json.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {
namespace {

Json zrna_attributes(const PlacedCam& cam, const ZrnaModule& module) {
  Json out = Json::array();
  for (const auto& [key, name] : module.attributes) {
    const auto value = cam.realised.number(key);
    if (!value) continue;
    const CamParameter* parameter = cam.cam->parameter(key);
    const double scale = parameter != nullptr && parameter->frequency ? 1e-3 : 1.0;
    out.push_back({{"name", name}, {"value", rounded_text(*value * scale, 9)}});
  }
  return out;
}

}  // namespace

std::optional<std::string> zrna_script(const Plan& plan) {
  // The script wires one CAM behind the other.
  if (plan.chips.size() != 1 || plan.wires.size() != plan.cams().size() + 1) return std::nullopt;
  const ChipPlan& chip = plan.chips[0];
  Json data;
  data["sys1"] = chip.clocks.sys1_divisor;
  data["clocks"] = Json::array();
  for (std::size_t k = 0; k < chip.clocks.clocks.size(); ++k) {
    data["clocks"].push_back({{"clock", k}, {"divisor", chip.clocks.clocks[k].divisor}});
  }
  data["cams"] = Json::array();
  for (const PlacedCam& cam : chip.cams) {
    const std::optional<ZrnaModule> module = cam.cam->zrna_module(cam);
    if (!module || cam.input_count() != 1) return std::nullopt;
    data["cams"].push_back({{"name", cam.name},
                            {"class", module->class_name},
                            {"arguments", module->arguments},
                            {"clock", cam.clock_index},
                            {"attributes", zrna_attributes(cam, *module)}});
  }
  return render_template("fpaa/zrna.py", data);
}

}  // namespace bodesmith::fpaa
