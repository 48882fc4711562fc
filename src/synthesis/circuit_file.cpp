#include "synthesis/circuit_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/documents/json.hpp"
#include "schematic/analysis/response.hpp"
#include "schematic/writers/parts_table.hpp"
#include "synthesis/ladders/rc_ladder.hpp"
#include "synthesis/realisation.hpp"

namespace bodesmith::synthesis {
namespace {

/// A transfer of any order, for a ladder: one pole and one zero a factor.
std::vector<Biquad> factors_from(const Node& node) {
  const Section all = section_from_node(node);
  if (all.poles.size() <= 2) return {Biquad::from_section(all)};
  std::vector<Biquad> out;
  for (std::size_t i = 0; i < all.poles.size(); ++i) {
    Section one;
    one.gain = i == 0 ? all.gain : 1.0;
    one.poles = {all.poles[i]};
    if (i < all.zeros.size()) one.zeros = {all.zeros[i]};
    out.push_back(Biquad::from_section(one));
  }
  return out;
}

Part part_from(const Node& node, std::size_t stage) {
  Part out;
  out.kind = node.has("realised_ohm") ? Part::Kind::resistor : Part::Kind::capacitor;
  const char* unit = out.kind == Part::Kind::resistor ? "ohm" : "f";
  out.name = node.at("part").string();
  out.group = stage;
  out.from = node.at("from").string();
  out.to = node.at("to").string();
  out.series = node.string_or("series", "");
  out.realised = node.at(fmt::format("realised_{}", unit)).positive();
  out.wanted = node.number_or(fmt::format("wanted_{}", unit), out.realised);
  return out;
}

OpAmpModel opamp_from(const Node& node) {
  OpAmpModel out;
  out.name = node.string_or("name", out.name);
  if (out.name == "ideal") return OpAmpModel::ideal();
  if (node.has("gain_bandwidth_hz")) out.gain_bandwidth = Hertz{node.at("gain_bandwidth_hz").positive()};
  out.dc_gain = node.number_or("dc_gain", out.dc_gain);
  out.slew_v_per_s = node.number_or("slew_v_per_s", out.slew_v_per_s);
  out.output_resistance_ohm = node.number_or("output_resistance_ohm", out.output_resistance_ohm);
  out.swing_v = node.number_or("swing_v", out.swing_v);
  return out;
}

bool about_equal(Complex a, Complex b) {
  return std::abs(a - b) <= 1e-6 * (std::abs(a) + std::abs(b));
}

/// One stage with its parts and op-amps.
class StageReader {
 public:
  StageReader(Circuit& circuit, std::size_t stages) : circuit_(circuit), stages_(stages) {}

  void read(const Node& node) {
    const std::size_t index = circuit_.stages.size();
    Stage stage;
    stage.realisation = node.at("realization").string();
    stage.in = node.at("in").string();
    stage.out = node.at("out").string();
    stage.wanted = factors_from(node.at("wanted"));
    stage.realised = factors_from(node.at("realised"));
    stage.first_part = circuit_.parts.size();
    for (const Node& part : node.at("parts").items()) circuit_.parts.push_back(part_from(part, index));
    stage.part_count = circuit_.parts.size() - stage.first_part;
    const std::string name = stage.realisation.substr(0, stage.realisation.find(' '));
    const Realisation* realisation = realisation_registry().find(name);
    if (realisation == nullptr)
      node.at("realization").fail(fmt::format("'{}' is not known", stage.realisation));
    std::vector<StageOpAmp> opamps;
    if (const StageRealisation* form = realisation->stage_realisation()) {
      stage.form = form_from(node, *form, stage);
      opamps = stage.form->opamps();
    } else if (realisation->ladder() != nullptr) {
      opamps = {{"U1", "0", "m", "out"}};
    } else {
      node.at("realization").fail("is no form of one stage");
    }
    const StageNodes place(index, stages_);
    for (const StageOpAmp& one : opamps) {
      circuit_.opamps.push_back({fmt::format("{}_{}", one.name, index + 1), "", index, place(one.plus),
                                 place(one.minus), place(one.out)});
    }
    circuit_.groups.push_back({stage.realisation});
    check(node, stage);
    circuit_.stages.push_back(std::move(stage));
  }

 private:
  std::shared_ptr<const StageForm> form_from(const Node& node, const StageRealisation& realisation,
                                             const Stage& stage) const {
    Section section = section_from_node(node.at("wanted"));
    section.gain = std::abs(section.gain);
    FormOptions options;
    for (const Part& part : circuit_.parts_of(stage)) {
      if (part.name.starts_with("Rs_")) options.isolation_ohm = part.realised;
    }
    std::shared_ptr<const StageForm> form = realisation.make(section, options);
    if (form->parts().size() != stage.part_count)
      node.at("parts").fail(fmt::format("are {}, expected {} for {}", stage.part_count, form->parts().size(),
                                        stage.realisation));
    return form;
  }

  void check(const Node& node, const Stage& stage) const {
    const std::vector<double> values = circuit_.realised_values(stage);
    for (const double hz : {1.0, 100.0, 1e4}) {
      const RadPerSecond w = Hertz{hz}.rad_s();
      const Complex got = stage.form ? stage.form->transfer(values).response(w)
                                     : ladder_response(stage.realisation, values, w);
      if (!about_equal(got, stage.response(w)))
        node.at("parts").fail("do not make what 'realised' says of the stage");
    }
  }

  /// -Z/R with the ladder in the feedback ("foster1 in the feedback"), -R/Z with it at the input, R the first of the values.
  static Complex ladder_response(const std::string& how, std::span<const double> values, RadPerSecond w) {
    const RcLadder* ladder = realisation_registry().find(how.substr(0, how.find(' ')))->ladder();
    const Complex z = ladder->impedance(values.subspan(1), {0.0, w.value});
    return -(how.ends_with("input") ? values[0] / z : z / values[0]);
  }

  Circuit& circuit_;
  std::size_t stages_;
};

}  // namespace

schematic::Tolerances tolerances_from(const Node& node) {
  node.allow_only({"resistor_percent", "capacitor_percent"});
  schematic::Tolerances out;
  const auto read = [&](const char* name, double& value) {
    if (!node.has(name)) return;
    value = node.at(name).non_negative();
    if (!(value < 100.0))
      node.at(name).fail(fmt::format("is {}, expected less than 100", rounded_text(value)));
  };
  read("resistor_percent", out.resistor_percent);
  read("capacitor_percent", out.capacitor_percent);
  return out;
}

Json to_json(const schematic::Tolerances& tolerances) {
  return {{"resistor_percent", tolerances.resistor_percent},
          {"capacitor_percent", tolerances.capacitor_percent}};
}

Section section_from_node(const Node& node) {
  return {.gain = node.at("gain").number(),
          .zeros = roots_from(node.at("zeros_rad_s")),
          .poles = roots_from(node.at("poles_rad_s"))};
}

Complex CircuitFile::wanted(RadPerSecond w) const {
  Complex h = 1.0;
  for (const Stage& stage : circuit.stages) h *= stage.wanted_response(w);
  return h;
}

CircuitFile CircuitFile::from_node(const Node& node) {
  node.expect_schema("circuit");
  CircuitFile out;
  if (node.has("opamp")) out.circuit.opamp = opamp_from(node.at("opamp"));
  if (node.has("tolerances")) out.circuit.tolerances = tolerances_from(node.at("tolerances"));
  const std::vector<Node> stages = node.at("stages").items();
  if (stages.empty()) node.at("stages").fail("is empty, expected at least one stage");
  StageReader reader(out.circuit, stages.size());
  for (const Node& stage : stages) reader.read(stage);
  const Node judged = node.has("judged") ? node.at("judged") : node.at("error");
  const std::vector<double> band = judged.at("band_hz").numbers();
  if (band.size() != 2 || !(band[0] > 0.0) || !(band[1] > band[0]))
    judged.at("band_hz").fail("expected [from, to]");
  out.band = {Hertz{band[0]}, Hertz{band[1]}};
  return out;
}

namespace {

Json section_json(const std::vector<Biquad>& factors) {
  Section all;
  for (const Biquad& h : factors) {
    const Section section = h.section();
    all.gain *= section.gain;
    all.zeros.insert(all.zeros.end(), section.zeros.begin(), section.zeros.end());
    all.poles.insert(all.poles.end(), section.poles.begin(), section.poles.end());
  }
  return {{"gain", all.gain}, {"zeros_rad_s", roots_json(all.zeros)}, {"poles_rad_s", roots_json(all.poles)}};
}

/// Greatest change of the magnitude over the report's band, dB for 1 % of each part, with ideal op-amps.
std::vector<double> worst_db_per_percent(const Realised& realised) {
  constexpr int kBandPoints = 61;
  const schematic::Equations equations(realised.circuit, {.ideal_opamps = true});
  std::vector<double> out(realised.circuit.parts.size(), 0.0);
  for (const Hertz f : log_grid(realised.report.band, kBandPoints)) {
    const auto slopes = schematic::log_sensitivities(equations, out.size(), f.rad_s());
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = std::max(out[i], 0.01 * kDecibelPerNeper * std::abs(slopes[i].real()));
  }
  return out;
}

}  // namespace

Json to_json(const ResponseDifference& difference) {
  return {{"max_magnitude_db", difference.max_magnitude_db},
          {"max_phase_deg", difference.max_phase_deg},
          {"max_complex_percent", difference.max_complex_percent},
          {"worst_hz", difference.worst.value}};
}

Json judged_json(const ResponseDifference& difference, Band band) {
  Json out = to_json(difference);
  out["band_hz"] = {band.from.value, band.to.value};
  return out;
}

Json to_json(const OpAmpCheck& check) {
  return {{"name", check.name},
          {"against_ideal", to_json(check.against_ideal)},
          {"least_phase_margin_deg", check.min_phase_margin_deg},
          {"tightest_stage", check.tightest_stage},
          {"output_offset_v", check.output_offset_v},
          {"full_swing_hz", check.full_swing_hz},
          {"output_current_a", check.output_current_a},
          {"highest_q", check.highest_q},
          {"noise_rms_v", check.noise_rms_v},
          {"warnings", check.warnings}};
}

Json to_json(const Realised& realised) {
  const std::vector<double> sensitivity = worst_db_per_percent(realised);
  const Circuit& circuit = realised.circuit;
  const RealiseReport& report = realised.report;
  Json out;
  out["stages"] = Json::array();
  for (const Stage& stage : circuit.stages) {
    Json parts = Json::array();
    for (std::size_t i = stage.first_part; i < stage.first_part + stage.part_count; ++i) {
      const Part& part = circuit.parts[i];
      Json one = {{"part", part.name}, {"from", part.from}, {"to", part.to}, {"series", part.series}};
      schematic::add_values(one, part);
      one["worst_db_per_percent"] = sensitivity[i];
      parts.push_back(std::move(one));
    }
    out["stages"].push_back({{"realization", stage.realisation},
                             {"in", stage.in},
                             {"out", stage.out},
                             {"wanted", section_json(stage.wanted)},
                             {"realised", section_json(stage.realised)},
                             {"parts", parts}});
  }
  out["tolerances"] = to_json(circuit.tolerances);
  out["opamps"] = circuit.opamps.size();
  out["opamp"] = {{"name", circuit.opamp.name},
                  {"gain_bandwidth_hz", circuit.opamp.gain_bandwidth.value},
                  {"dc_gain", circuit.opamp.dc_gain},
                  {"slew_v_per_s", circuit.opamp.slew_v_per_s},
                  {"output_resistance_ohm", circuit.opamp.output_resistance_ohm},
                  {"swing_v", circuit.opamp.swing_v}};
  out["nodes"] = {{"highest_db", report.highest_node_db}, {"lowest_db", report.lowest_node_db}};
  out["error"] = {{"band_hz", {report.band.from.value, report.band.to.value}},
                  {"parts", to_json(report.parts)},
                  {"nearest_rounding", to_json(report.nearest)},
                  {"opamps", to_json(report.opamps)},
                  {"all", to_json(report.all)}};
  out["warnings"] = report.warnings;
  return out;
}

}  // namespace bodesmith::synthesis
