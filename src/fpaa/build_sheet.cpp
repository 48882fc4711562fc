#include "fpaa/build_sheet.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/json.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "fpaa/cam_words.hpp"

namespace bodesmith::fpaa {
namespace {

/// "250 kHz": clocks and corners as AnadigmDesigner2 writes them.
std::string in_khz(double hertz, int digits = 6) {
  return rounded_text(hertz / 1e3, digits) + " kHz";
}

Json parameter_rows(const PlacedCam& cam) {
  Json rows = Json::array();
  for (const auto& [key, value] : cam.requested.items()) {
    if (!value.is_number()) continue;
    const CamWord* word = find_word(key);
    const bool frequency = word != nullptr && word->frequency;
    const std::string words = word != nullptr ? std::string(word->words) : key;
    const auto text = [&](double v) { return frequency ? in_khz(v) : rounded_text(v, 6); };
    // What to type is the realised value: the tool then has a set of capacitors that is exact.
    const double type = cam.realised.contains(key) ? cam.realised[key].get<double>() : value.get<double>();
    rows.push_back({{"words", words},
                    {"requested", text(value.get<double>())},
                    {"type", text(type)},
                    {"off", fmt::format("{:+.3f} %", 100.0 * (type / value.get<double>() - 1.0))}});
  }
  return rows;
}

Json sheet_data(const Plan& plan) {
  Json data;
  const Board& board = board_by_name(plan.board);
  data["board"] = plan.board;
  data["chip_type"] = board.chip;
  data["chips"] = Json::array();
  int step = 0;
  for (const ChipPlan& chip : plan.chips) {
    Json item;
    item["chip"] = chip.chip;
    item["master"] = rounded_text(chip.master_clock.value / 1e6) + " MHz";
    item["sys1_divisor"] = chip.clocks.sys1_divisor;
    item["sys2_divisor"] = chip.clocks.sys2_divisor;
    item["sys1"] = in_khz(chip.master_clock.value / chip.clocks.sys1_divisor);
    item["sys2"] = in_khz(chip.master_clock.value / chip.clocks.sys2_divisor);
    item["clocks"] = Json::array();
    for (size_t k = 0; k < chip.clocks.clocks.size(); ++k) {
      item["clocks"].push_back({{"clock", k},
                                {"system", chip.clocks.clocks[k].system},
                                {"divisor", chip.clocks.clocks[k].divisor},
                                {"frequency", in_khz(chip.clocks.frequency(board, k).value)}});
    }
    item["cams"] = Json::array();
    for (const PlacedCam& cam : chip.cams) {
      Json capacitors = Json::array();
      for (const Capacitor& c : cam.capacitors) {
        capacitors.push_back({{"name", c.name}, {"units", c.units}});
      }
      item["cams"].push_back(
          {{"step", ++step},
           {"name", cam.name},
           {"cam", cam.cam},
           {"option", cam.option.empty() ? Json(false) : Json(cam.option)},
           {"cab", cam.cab},
           {"clock_a", fmt::format("{} (Chip Clock {})", in_khz(cam.clock_a.value), cam.clock_index)},
           {"phase", fmt::format("Phase {}", cam.phase)},
           {"section", cam.section ? Json(fmt::format("section {}", *cam.section + 1)) : Json(false)},
           {"parameters", parameter_rows(cam)},
           {"capacitors", capacitors}});
    }
    const Resources sum = chip.resources();
    item["opamps"] = sum.opamps;
    item["capacitors"] = sum.capacitors;
    item["opamps_available"] = board.cabs_per_chip * board.per_cab.opamps;
    item["capacitors_available"] = board.cabs_per_chip * board.per_cab.capacitors;
    data["chips"].push_back(item);
  }
  data["wires"] = Json::array();
  for (size_t i = 0; i + 1 < plan.signal_path.size(); ++i) {
    data["wires"].push_back({{"from", plan.signal_path[i]}, {"to", plan.signal_path[i + 1]}});
  }
  const auto error = [](const PlanError& e) {
    return Json{
        {"from", rounded_text(e.band.from.value)},           {"to", rounded_text(e.band.to.value)},
        {"db", rounded_text(e.max_magnitude_db, 3)},         {"deg", rounded_text(e.max_phase_deg, 3)},
        {"percent", rounded_text(e.max_complex_percent, 3)}, {"worst", rounded_text(e.worst.value, 3)}};
  };
  data["error"] = error(plan.error);
  data["delayed"] = error(plan.error_with_delays);
  data["largest_input"] = rounded_text(plan.largest_input_v, 3);
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

}  // namespace bodesmith::fpaa
