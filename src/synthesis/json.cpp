#include "synthesis/json.hpp"

#include <algorithm>

#include "base/json.hpp"
#include "schematic/analysis/response.hpp"

namespace bodesmith::circuit {
namespace {

Json section_json(const std::vector<Biquad>& factors) {
  Json out;
  double gain = 1.0;
  out["gain"] = gain;
  out["zeros_rad_s"] = Json::array();
  out["poles_rad_s"] = Json::array();
  for (const Biquad& h : factors) {
    const Section section = h.section();
    gain *= section.gain;
    for (const auto& zero : section.zeros) out["zeros_rad_s"].push_back({zero.real(), zero.imag()});
    for (const auto& pole : section.poles) out["poles_rad_s"].push_back({pole.real(), pole.imag()});
  }
  out["gain"] = gain;
  return out;
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
      const bool resistor = part.kind == Part::Kind::resistor;
      parts.push_back({{"part", part.name},
                       {"from", part.from},
                       {"to", part.to},
                       {"series", part.series},
                       {resistor ? "wanted_ohm" : "wanted_f", part.wanted},
                       {resistor ? "realised_ohm" : "realised_f", part.realised},
                       {"worst_db_per_percent", sensitivity[i]}});
    }
    out["stages"].push_back({{"realization", stage.realisation},
                             {"in", stage.in},
                             {"out", stage.out},
                             {"wanted", section_json(stage.wanted)},
                             {"realised", section_json(stage.realised)},
                             {"parts", parts}});
  }
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

}  // namespace bodesmith::circuit
