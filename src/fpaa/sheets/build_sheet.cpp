#include "fpaa/sheets/build_sheet.hpp"

#include <fmt/format.h>

#include "base/documents/json.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {
namespace {

/// "250 kHz": clocks and corners as AnadigmDesigner2 writes them.
std::string in_khz(double hertz) {
  return rounded_text(hertz / 1e3, 6) + " kHz";
}

Json parameter_rows(const PlacedCam& cam) {
  Json rows = Json::array();
  for (const CamValues::Entry& entry : cam.requested.entries()) {
    const auto requested = entry.number();
    if (!requested) continue;
    const CamParameter* parameter = cam.cam->parameter(entry.key);
    const bool frequency = parameter != nullptr && parameter->frequency;
    const auto text = [&](double v) { return frequency ? in_khz(v) : rounded_text(v, 6); };
    // What to type is the realised value: the tool then has a set of capacitors that is exact.
    const double type = cam.realised.number(entry.key).value_or(*requested);
    rows.push_back(
        {{"words", parameter != nullptr ? std::string(parameter->words) : entry.key},
         {"requested", text(*requested)},
         {"type", text(type)},
         {"off", *requested == 0.0 ? "-" : fmt::format("{:+.3f} %", 100.0 * (type / *requested - 1.0))}});
  }
  return rows;
}

Json cam_rows(const PlacedCam& cam, int step) {
  Json capacitors = Json::array();
  for (const Capacitor& c : cam.capacitors) capacitors.push_back({{"name", c.name}, {"units", c.units}});
  return {{"step", step},
          {"name", cam.name},
          {"cam", cam.cam_name()},
          {"option", cam.option.empty() ? Json(false) : Json(cam.option)},
          {"cab", cam.cab},
          {"clock_a", fmt::format("{} (Chip Clock {})", in_khz(cam.clock_a.value), cam.clock_index)},
          {"phase", fmt::format("Phase {}", cam.phase)},
          {"parameters", parameter_rows(cam)},
          {"capacitors", capacitors}};
}

/// Clocks and resources of a chip; its CAMs are numbered on from `step`.
Json chip_rows(const ChipPlan& chip, int& step) {
  Json out;
  out["chip"] = chip.chip;
  out["master"] = rounded_text(chip.master_clock.value / 1e6) + " MHz";
  out["sys1_divisor"] = chip.clocks.sys1_divisor;
  out["sys2_divisor"] = chip.clocks.sys2_divisor;
  out["sys1"] = in_khz(chip.master_clock.value / chip.clocks.sys1_divisor);
  out["sys2"] = in_khz(chip.master_clock.value / chip.clocks.sys2_divisor);
  out["clocks"] = Json::array();
  for (std::size_t k = 0; k < chip.clocks.clocks.size(); ++k) {
    out["clocks"].push_back({{"clock", k},
                             {"system", chip.clocks.clocks[k].system},
                             {"divisor", chip.clocks.clocks[k].divisor},
                             {"frequency", in_khz(chip.clocks.frequency(chip.master_clock, k).value)}});
  }
  out["cams"] = Json::array();
  for (const PlacedCam& cam : chip.cams) out["cams"].push_back(cam_rows(cam, ++step));
  const Resources sum = chip.resources();
  out["opamps"] = sum.opamps;
  out["capacitors"] = sum.capacitors;
  out["opamps_available"] = kCabs * kOpAmps;
  out["capacitors_available"] = kCabs * kCapacitors;
  return out;
}

Json error_texts(const PlanError& e) {
  return {{"from", rounded_text(e.band.from.value)},           {"to", rounded_text(e.band.to.value)},
          {"db", rounded_text(e.max_magnitude_db, 3)},         {"deg", rounded_text(e.max_phase_deg, 3)},
          {"percent", rounded_text(e.max_complex_percent, 3)}, {"worst", rounded_text(e.worst.value, 3)}};
}

/// Whether the CAM at the wire's end has several inputs.
bool has_inputs(const Plan& plan, const Wire& wire) {
  for (const ChipPlan& chip : plan.chips) {
    for (const PlacedCam& cam : chip.cams) {
      if (wire.to == fmt::format("chip{}.{}", chip.chip, cam.name)) return cam.input_count() > 1;
    }
  }
  return false;
}

Json sheet_data(const Plan& plan) {
  Json data;
  data["board"] = plan.board;
  data["chip_type"] = board_by_name(plan.board).chip;
  data["chips"] = Json::array();
  int step = 0;
  for (const ChipPlan& chip : plan.chips) data["chips"].push_back(chip_rows(chip, step));
  data["wires"] = Json::array();
  for (const Wire& wire : plan.wires) {
    data["wires"].push_back({{"from", wire.from},
                             {"to", wire.to},
                             {"input", has_inputs(plan, wire) ? Json(wire.input) : Json(false)}});
  }
  std::vector<std::string> foreign;
  const auto cams = plan.cams();
  for (const PlacedCam* cam : cams) {
    if (!cam->cam->in_vendor_menu(*cam)) foreign.push_back(cam->name);
  }
  data["foreign"] =
      foreign.empty() ? Json(false)
                      : Json{{"count", foreign.size()}, {"all", cams.size()}, {"names", join(foreign, ", ")}};
  data["image"] =
      plan.image ? Json(fmt::format(
                       "{} dB at {} Hz, with a sine of {} Hz", rounded_text(plan.image->magnitude_db, 3),
                       rounded_text(plan.image->line.value, 4), rounded_text(plan.image->signal.value, 4)))
                 : Json(false);
  data["delayed"] = error_texts(plan.error_with_delays);
  data["largest_input"] = rounded_text(plan.max_input_v, 3);
  data["assumptions"] = plan.assumptions;
  data["notes"] = plan.notes;
  return data;
}

}  // namespace

std::string build_sheet_markdown(const Plan& plan) {
  return render_template("fpaa/build_sheet.md", sheet_data(plan));
}

std::string build_sheet_html(const Plan& plan) {
  return render_template("fpaa/build_sheet.html", sheet_data(plan));
}
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
