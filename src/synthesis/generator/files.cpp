#include "synthesis/generator/files.hpp"

#include <fmt/format.h>

#include "base/documents/json.hpp"
#include "base/text.hpp"
#include "base/version.hpp"
#include "schematic/writers/kicad/schematic.hpp"
#include "schematic/writers/parts_table.hpp"
#include "schematic/writers/spice_library.hpp"

namespace bodesmith::generator {
namespace {

Json multiplier_json(const Multiplier& m) {
  return {{"name", m.name}, {"what", m.role}, {"x", m.x},          {"y", m.y},
          {"z", m.z},       {"w", m.out},     {"peak_v", m.peak_v}};
}

Json amplitude_json(const DisturbanceCircuit& layout) {
  const AmplitudeControl& a = *layout.amplitude;
  Json out = {{"alpha", a.alpha}, {"gains", a.wanted}, {"at_rest", Json::array()}};
  for (const Branch& one : layout.branches) out["at_rest"].push_back(one.amplitude.at_rest);
  out["gain_multipliers"] = Json::array();
  for (const int m : a.multipliers)
    out["gain_multipliers"].push_back(multiplier_json(layout.multipliers[static_cast<std::size_t>(m)]));
  out["max_error_percent"] = a.max_error_percent;
  return out;
}

Json switch_json(const DisturbanceCircuit& layout) {
  Json out = {{"name", layout.analog_switch.name},
              {"on_ohm", layout.analog_switch.on_ohm},
              {"on_delay_s", layout.analog_switch.on_delay_s},
              {"break_before_make_s", layout.analog_switch.gap_s},
              {"charge_injection_c", layout.analog_switch.charge_c},
              {"source_capacitance_f", layout.analog_switch.source_f},
              {"drain_capacitance_f", layout.analog_switch.drain_f},
              {"select_lines", layout.select_lines()},
              {"control", "branch > 0.5 V: " + layout.branches[0].name},
              {"codes", Json::array()}};
  for (int select = 0; select < (1 << layout.select_lines()); ++select) {
    for (const bool rising : {true, false}) {
      const int b = layout.branch_at(select, rising);
      out["codes"].push_back({{"select", select},
                              {"branch_v", rising ? 1 : 0},
                              {"name", b < 0 ? "none" : layout.branches[static_cast<size_t>(b)].name}});
    }
  }
  return out;
}

Json lines_json(const std::vector<BudgetLine>& lines) {
  Json out = Json::array();
  for (const BudgetLine& one : lines) out.push_back({{"cause", one.cause}, {"percent", one.percent}});
  return out;
}

}  // namespace

Json to_json(const DisturbanceCircuit& layout) {
  Json out;
  out["multiplier"] = {{"name", layout.multiplier.name},
                       {"scale_v", layout.multiplier.scale_v},
                       {"greatest_input_v", layout.multiplier.greatest_input_v},
                       {"bandwidth_hz", layout.multiplier.bandwidth.value}};
  out["fast_opamp"] = layout.other_opamps.at(0).name;
  out["opamp"] = {{"name", layout.opamp.name}, {"gain_bandwidth_hz", layout.opamp.gain_bandwidth.value}};
  out["opamps"] = layout.opamps.size();
  out["branch_gain"] = layout.branch_gain;
  out["schemes"] = Json::array();
  for (const Candidate& one : layout.candidates) {
    out["schemes"].push_back({{"name", one.name},
                              {"powers_to_a_group", one.group},
                              {"multipliers", one.multipliers},
                              {"opamps", one.opamps},
                              {"multipliers_in_series", one.depth},
                              {"rss_percent", one.rss_percent},
                              {"bandwidth_hz", one.bandwidth.value},
                              {"chosen", one.chosen}});
  }
  out["multipliers"] = Json::array();
  for (const Multiplier& one : layout.multipliers) {
    if (layout.purpose_of(one.group) != schematic::Purpose::amplitude)
      out["multipliers"].push_back(multiplier_json(one));
  }
  out["branches"] = Json::array();
  for (const Branch& b : layout.branches) {
    out["branches"].push_back({{"name", b.name},
                               {"wanted", b.wanted},
                               {"realised", b.realised},
                               {"peak_v", b.peak_v},
                               {"max_error_percent", b.max_error_percent}});
  }
  if (layout.switched()) out["switch"] = switch_json(layout);
  if (layout.amplitude) out["amplitude"] = amplitude_json(layout);
  out["nodes"] = Json::array();
  for (const NodeRange& node : layout.nodes) {
    out["nodes"].push_back({{"name", node.name},
                            {"what", node.what},
                            {"lowest_v", node.lowest_v},
                            {"highest_v", node.highest_v}});
  }
  out["parts"] = schematic::parts_json(layout, "part");
  out["error"] = {{"max_error_percent", layout.max_error_percent}};
  if (layout.of_full_strokes)
    out["error"]["disturbance_sub_max_percent"] = layout.of_full_strokes->max_error_percent;
  out["warnings"] = layout.warnings;
  return out;
}

namespace {

Json to_json(const Budget& budget) {
  Json out;
  out["assumed"] = to_json(budget.errors);
  out["rss_percent"] = budget.rss_percent;
  out["worst_percent"] = budget.worst_percent;
  out["causes"] = lines_json(budget.lines);
  return out;
}

Json to_json(const Timing& timing) {
  Json out;
  out["slope_detector"] = {{"threshold_v", timing.detector.threshold_v},
                           {"least_slope_v_per_s", timing.detector.least_slope_v_per_s},
                           {"noise_rms_v", timing.detector.noise_v},
                           {"hysteresis_over_noise", timing.detector.noise_margin},
                           {"tolerated_50_hz_v", timing.detector.hum_50_hz_v},
                           {"tolerated_ripple_v", timing.detector.ripple_v},
                           {"ripple_hz", timing.detector.ripple_hz},
                           {"delays", Json::array()}};
  const auto maybe = [](const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); };
  for (const SlopeDetectorFigures::Delay& one : timing.detector.delays) {
    out["slope_detector"]["delays"].push_back({{"frequency_hz", one.frequency.value},
                                               {"triangle_s", maybe(one.triangle_s)},
                                               {"sine_s", maybe(one.sine_s)}});
  }
  out["switch"] = {{"opens_s", timing.analog_switch.opens_s},
                   {"closes_s", timing.analog_switch.closes_s},
                   {"hold_s", timing.analog_switch.hold_s},
                   {"charge_step_v", timing.analog_switch.charge_step_v},
                   {"droop_percent", timing.analog_switch.droop_percent},
                   {"charge_percent", timing.analog_switch.charge_percent},
                   {"glitch_percent", timing.analog_switch.glitch_percent},
                   {"glitch_area_percent_s", timing.analog_switch.glitch_area_percent_s},
                   {"late", Json::array()}};
  for (const SwitchFigures::Late& one : timing.analog_switch.late) {
    out["switch"]["late"].push_back({{"frequency_hz", one.frequency.value},
                                     {"delay_s", one.delay_s},
                                     {"step_percent", one.step_percent},
                                     {"rms_percent", one.rms_percent},
                                     {"rms_multipliers_off_percent", one.rms_off_percent},
                                     {"peak_percent", one.peak_percent}});
  }
  return out;
}

Json transient_budget_json(const Timing& timing) {
  Json out = Json::array();
  const double gap = timing.analog_switch.closes_s - timing.analog_switch.opens_s;
  out.push_back({{"cause", "break before make, droop from full scale"},
                 {"percent", timing.analog_switch.droop_percent},
                 {"lasts_s", gap}});
  out.push_back({{"cause", "break before make, injected charge"},
                 {"percent", timing.analog_switch.charge_percent},
                 {"lasts_s", gap}});
  for (const SwitchFigures::Late& one : timing.analog_switch.late) {
    out.push_back({{"cause", "late branch"},
                   {"frequency_hz", one.frequency.value},
                   {"percent", one.step_percent},
                   {"lasts_s", one.delay_s}});
  }
  return out;
}

std::string codes_of(const DisturbanceCircuit& layout) {
  std::vector<std::string> out;
  for (int select = 0; select < (1 << layout.select_lines()); ++select) {
    for (const bool rising : {true, false}) {
      const int b = layout.branch_at(select, rising);
      if (b >= 0)
        out.push_back(fmt::format("{}{}: {}", select, rising ? " up" : " down",
                                  layout.branches[static_cast<size_t>(b)].name));
    }
  }
  return join(out, ", ");
}

std::vector<std::string> notes_of(const DisturbanceCircuit& layout) {
  std::vector<std::string> out = {fmt::format(
      "x: 1 V is full stroke; branch above 0.5 V: {}; out: 1 V is d = 1. {}", layout.branches[0].name,
      layout.amplitude ? "With the amplitude gains." : "Without the gain tables.")};
  if (layout.select_lines() > 0) out.push_back("select lines, binary, select1 lowest; " + codes_of(layout));
  if (layout.amplitude) {
    out.push_back(
        "amplitude: the stroke alpha, 1 V is full stroke; x is the reference divided by alpha, 0 to 1 V.");
    out.push_back("This file stands alone: it is not to be included together with disturbance.sub.");
  }
  out.push_back("slope_detector x branch: makes the branch signal from the slope of x.");
  out.push_back("No analysis and no control section: for ngspice, LTspice and Xyce alike.");
  return out;
}

}  // namespace

Json to_json(const DisturbanceCircuit& layout, const Budget& budget, const Timing& timing) {
  Json out = to_json(layout);
  out["budget"] = to_json(budget);
  if (!layout.switched()) return out;
  out["timing"] = to_json(timing);
  out["budget"]["transient"] = transient_budget_json(timing);
  return out;
}

std::string disturbance_name(const DisturbanceCircuit& layout) {
  return layout.amplitude ? "disturbance_amplitude" : "disturbance";
}

std::string disturbance_pins(const DisturbanceCircuit& layout) {
  std::string out = "x branch";
  for (int line = 1; line <= layout.select_lines(); ++line) out += fmt::format(" select{}", line);
  return out + (layout.amplitude ? " amplitude out" : " out");
}

std::string disturbance_library(const DisturbanceCircuit& layout, const std::string& title,
                                bool multipliers_are_off) {
  schematic::SpiceLibrary out;
  out.title = title;
  out.written_by = std::string("bodesmith ") + kVersion;
  out.top = disturbance_name(layout);
  out.notes = notes_of(layout);
  schematic::Subcircuit top;
  top.name = out.top;
  const std::string pins = disturbance_pins(layout);
  for (const std::string_view pin : split(pins, ' ')) top.pins.emplace_back(pin);
  top.netlist = layout.generator();
  schematic::Deviations off = schematic::Deviations::none(top.netlist);
  if (multipliers_are_off) off.multiplier = multipliers_off(layout).multiplier;
  out.subcircuits.push_back(std::move(top));
  if (layout.switched())
    out.subcircuits.push_back(
        {"slope_detector",
         {"x", "branch"},
         {"slope detector: differentiator with a logarithmic limit, comparator with hysteresis, 0 V or 1 V out"},
         layout.detector_netlist()});
  return schematic::spice_text(out, {.off = multipliers_are_off ? &off : nullptr});
}

void add_libraries(const DisturbanceCircuit& layout, const std::string& title, OutputSet& out,
                   const std::filesystem::path& folder) {
  if (layout.of_full_strokes) add_libraries(*layout.of_full_strokes, title, out, folder);
  out.add(folder / (disturbance_name(layout) + ".sub"), disturbance_library(layout, title));
}

namespace {

kicad::SheetOptions sheet_of(const DisturbanceCircuit& layout, const std::string& title) {
  return {.stem = "layout",
          .title = title,
          .comment = fmt::format("bodesmith {}; op-amps {}", kVersion, layout.opamp.name),
          .ports = layout.ports()};
}

}  // namespace

std::string layout_svg(const DisturbanceCircuit& layout, const std::string& title) {
  return kicad::netlist_svg(layout, sheet_of(layout, title));
}

void add_layout_files(const DisturbanceCircuit& layout, const std::string& title, const Json& json,
                      OutputSet& out) {
  out.add("layout.json", to_text(json));
  add_libraries(layout, title, out);
  out.add("parts.csv", schematic::parts_csv(layout));
  // The pins of an 8-way switch are not known.
  if (layout.contacts.size() <= 2) {
    kicad::add_netlist_project(layout, sheet_of(layout, title), out, "");
  } else {
    out.add("layout.svg", layout_svg(layout, title));
  }
}

}  // namespace bodesmith::generator
