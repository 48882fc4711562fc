#include "synthesis/built_circuit.hpp"

#include <fmt/format.h>

#include <cmath>

#include "synthesis/ladders/rc_ladder.hpp"
#include "synthesis/realisation.hpp"
#include "synthesis/stages/placement.hpp"

namespace bodesmith::circuit {
namespace {

using Complex = std::complex<double>;

std::vector<Complex> roots_from(const Node& node) {
  std::vector<Complex> out;
  for (const Node& root : node.items()) {
    const std::vector<double> parts = root.numbers();
    if (parts.size() != 2) root.fail("is no root, expected [re, im] in rad/s");
    out.emplace_back(parts[0], parts[1]);
  }
  return out;
}

Section section_from(const Node& node) {
  return {.gain = node.at("gain").number(),
          .zeros = roots_from(node.at("zeros_rad_s")),
          .poles = roots_from(node.at("poles_rad_s"))};
}

/// A transfer of any order, for a ladder: one pole and one zero a factor.
std::vector<Biquad> factors_from(const Node& node) {
  const Section all = section_from(node);
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
    Section section = section_from(node.at("wanted"));
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
    const PartsResponse ladder = ladder_response(stage);
    for (const double hz : {1.0, 100.0, 1e4}) {
      const RadPerSecond w = Hertz{hz}.rad_s();
      const Complex got = ladder ? ladder(values, w) : stage.form->transfer(values).response(w);
      if (!about_equal(got, stage.response(w)))
        node.at("parts").fail("do not make what 'realised' says of the stage");
    }
  }

  Circuit& circuit_;
  std::size_t stages_;
};

}  // namespace

PartsResponse ladder_response(const Stage& stage) {
  // "foster1 in the feedback", "cauer2 at the input".
  const Realisation* realisation =
      realisation_registry().find(stage.realisation.substr(0, stage.realisation.find(' ')));
  if (realisation == nullptr || realisation->ladder() == nullptr) return nullptr;
  const bool in_feedback = !stage.realisation.ends_with("input");
  return [ladder = realisation->ladder(), in_feedback](std::span<const double> values, RadPerSecond w) {
    const std::complex<double> z = ladder->impedance(values.subspan(1), {0.0, w.value});
    return -(in_feedback ? z / values[0] : values[0] / z);
  };
}

std::complex<double> CircuitFile::wanted(RadPerSecond w) const {
  Complex h = 1.0;
  for (const Stage& stage : circuit.stages) h *= stage.wanted_response(w);
  return h;
}

CircuitFile CircuitFile::from_node(const Node& node) {
  node.expect_schema("circuit");
  CircuitFile out;
  if (node.has("opamp")) out.circuit.opamp = opamp_from(node.at("opamp"));
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

}  // namespace bodesmith::circuit
