#include "fpaa/zrna_script.hpp"

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/json.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"

namespace bodesmith::fpaa {
namespace {

std::string module_class(const PlacedCam& cam) {
  if (cam.cam == "GainInv") return "GainInv";
  if (cam.cam == "FilterBilinear") {
    return cam.option == "Pole and Zero" ? "FilterPoleZero"
           : cam.option == "Low Pass"    ? "FilterLowpass"
                                         : "FilterHighpass";
  }
  return cam.option == "Low Pass"    ? "FilterBiquadLowpass"
         : cam.option == "Band Pass" ? "FilterBiquadBandpass"
                                     : "FilterBiquadHighpass";
}

Json parameters(const PlacedCam& cam) {
  Json out = Json::array();
  const auto add = [&](const char* key, const char* name, double scale) {
    if (!cam.realised.contains(key)) return;
    out.push_back({{"name", name}, {"value", rounded_text(cam.realised[key].get<double>() * scale, 9)}});
  };
  const bool band = cam.option == "Band Pass";
  add("pole_hz", "pole_frequency", 1e-3);
  add("zero_hz", "zero_frequency", 1e-3);
  add("corner_hz", band ? "center_frequency" : "corner_frequency", 1e-3);
  add("quality", "quality_factor", 1.0);
  add("dc_gain", "dc_gain", 1.0);
  add("gain", "gain", 1.0);
  return out;
}

}  // namespace

std::string zrna_script(const Plan& plan) {
  if (plan.chips.size() != 1) {
    throw DesignError(fmt::format("the plan takes {} chips, a Zrna board has one", plan.chips.size()));
  }
  const ChipPlan& chip = plan.chips[0];
  Json data;
  data["sys1"] = chip.clocks.sys1_divisor;
  data["clocks"] = Json::array();
  for (size_t k = 0; k < chip.clocks.clocks.size(); ++k) {
    data["clocks"].push_back({{"clock", k}, {"divisor", chip.clocks.clocks[k].divisor}});
  }
  data["cams"] = Json::array();
  for (const PlacedCam& cam : chip.cams) {
    data["cams"].push_back({{"name", cam.name},
                            {"class", module_class(cam)},
                            {"clock", cam.clock_index},
                            {"pole_zero", cam.option == "Pole and Zero"},
                            {"parameters", parameters(cam)}});
  }
  return render_template("fpaa/zrna.py", data);
}

}  // namespace bodesmith::fpaa
