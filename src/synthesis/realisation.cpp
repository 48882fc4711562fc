#include "synthesis/realisation.hpp"

#include <fmt/format.h>

namespace bodesmith::synthesis {

std::vector<double> StageForm::capacitors(std::span<const double> values) const {
  std::vector<double> out;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    if (parts_[i].kind == Part::Kind::capacitor) out.push_back(values[i]);
  }
  return out;
}

std::optional<std::vector<double>> StageForm::exact_near(std::span<const double> values) const {
  return design(capacitors(values));
}

std::string StageNodes::operator()(const std::string& local) const {
  if (local == "0") return local;
  if (local == "in") return stage_ == 0 ? "in" : fmt::format("n{}", stage_);
  if (local == "out") return stage_ + 1 == stages_ ? "out" : fmt::format("n{}", stage_ + 1);
  return fmt::format("s{}_{}", stage_ + 1, local);
}

std::string StageNodes::local_name(const Stage& stage, std::size_t index, const std::string& node) {
  if (node == "0") return node;
  if (node == stage.in) return "in";
  if (node == stage.out) return "out";
  const std::string prefix = fmt::format("s{}_", index + 1);
  return node.starts_with(prefix) ? node.substr(prefix.size()) : node;
}

void add_stage(Circuit& circuit, const StageDesign& design, std::size_t stages,
               const RealiseOptions& options) {
  const std::size_t index = circuit.stages.size();
  const StageNodes node(index, stages);
  Stage stage;
  stage.realisation = design.realisation;
  stage.wanted = design.wanted;
  stage.realised = design.realised;
  stage.in = node("in");
  stage.out = node("out");
  stage.first_part = circuit.parts.size();
  stage.part_count = design.parts.size();
  stage.form = design.form;
  for (std::size_t i = 0; i < design.parts.size(); ++i) {
    const StagePart& drawn = design.parts[i];
    const Series& series = drawn.kind == Part::Kind::resistor ? options.resistors : options.capacitors;
    circuit.parts.push_back({drawn.kind, fmt::format("{}_{}", drawn.name, index + 1), "", index,
                             node(drawn.from), node(drawn.to), series.name(), design.wanted_values[i],
                             design.realised_values[i]});
  }
  for (const StageOpAmp& drawn : design.opamps) {
    circuit.opamps.push_back({fmt::format("{}_{}", drawn.name, index + 1), "", index, node(drawn.plus),
                              node(drawn.minus), node(drawn.out)});
  }
  circuit.groups.push_back({stage.realisation});
  circuit.stages.push_back(std::move(stage));
}

// A name a realisation: the function that its own file defines. opamp_rc() chooses among the stages.
BODESMITH_REGISTRY(Realisation, realisation_registry, "realization", opamp_rc, first_order,
                   first_order_right_zero, first_order_trimmed, inverter_realisation, tow_thomas, khn,
                   sallen_key, multiple_feedback, foster1_realisation, foster2_realisation,
                   cauer1_realisation, cauer2_realisation)

Outcome<Realised> try_realise(const Sections& sections, const RealiseOptions& options) {
  options.limits.validate();
  Outcome<Realised> out = realisation_registry().get(options.realisation).design(sections, options);
  if (auto* made = std::get_if<Realised>(&out)) made->circuit.tolerances = options.tolerances;
  return out;
}

Realised realise(const Sections& sections, const RealiseOptions& options) {
  return value_or_throw(try_realise(sections, options));
}

}  // namespace bodesmith::synthesis
