#include "project/run_models.hpp"

#include <algorithm>
#include <tuple>

#include "chain/registry.hpp"
#include "chain/sections_chain.hpp"
#include "chain/stage_chain.hpp"
#include "controller/at_rest.hpp"

namespace bodesmith::project {
namespace {

using Branch = Disturbance::Branch;
using chain::Block;
using chain::make_block;

Hertz lowest_tracked(const Project& project) {
  return *std::min_element(project.track.frequency.begin(), project.track.frequency.end());
}

Block called(Block block, const char* name) {
  block.part = name;
  return block;
}

Block loop_of(const controller::AnalogController& controller, const Disturbance& disturbance,
              Hertz operating) {
  controller::BuiltGenerator built(controller);
  std::vector<double> frequency;
  for (const Hertz f : disturbance.rate.frequency) frequency.push_back(f.value);
  Block out = make_block("loop");
  for (const auto& [which, list, constant, rates] :
       {std::tuple{Branch::ascending, "ascending", "constant_ascending", "rate_ascending"},
        {Branch::descending, "descending", "constant_descending", "rate_descending"}}) {
    // A cubic through four of its values: what the powers, sums and gains with their parts make.
    built.set_rate(operating);
    const double gain = built.rate_gain(which);
    double y[4];
    for (int i = 0; i < 4; ++i) y[i] = built.subtracted(which, i / 3.0) / gain;
    const double d1 = y[1] - y[0];
    const double d2 = y[2] - 2.0 * y[1] + y[0];
    const double d3 = y[3] - 3.0 * y[2] + 3.0 * y[1] - y[0];
    out.set(list, std::vector<double>{3.0 * d1 - 1.5 * d2 + d3, 4.5 * d2 - 4.5 * d3, 4.5 * d3});
    out.set(constant, y[0] * gain);
    std::vector<double> gains;
    for (const Hertz f : disturbance.rate.frequency) {
      built.set_rate(f);
      gains.push_back(built.rate_gain(which));
    }
    out.set(rates, gains);
  }
  out.set("rate_frequency_hz", frequency).set("operating_hz", operating.value);
  out.set("passes", controller.form == controller::Form::self_fed   ? 0.0
                    : controller.form == controller::Form::two_pass ? 2.0
                                                                    : 1.0);
  return called(std::move(out), "controller");
}

}  // namespace

chain::Chain stage_model(const Project& project) {
  chain::Chain out;
  const Project::Plant& plant = project.plant;
  if (plant.amplifier_corner)
    out.blocks.push_back(
        called(make_block("lowpass").set("corner_hz", plant.amplifier_corner->value), "amplifier"));
  out.blocks.push_back(chain::stage_block(project.target.disturbance, lowest_tracked(project)));
  if (plant.damping_compensator) {
    Sections one;
    one.sections = {*plant.damping_compensator};
    for (Block& block : chain::chain_of(one, "damping").blocks) out.blocks.push_back(std::move(block));
  }
  if (plant.resonance)
    out.blocks.push_back(called(make_block("resonator")
                                    .set("natural_frequency_hz", plant.resonance->value)
                                    .set("damping_ratio", plant.damping_ratio),
                                "resonance"));
  out.blocks.push_back(called(make_block("gain").set("gain", plant.stroke_m), "stroke_m"));
  return out;
}

std::optional<chain::Chain> built_model(const ProjectRun& run) {
  if (!run.design.controller) return std::nullopt;
  chain::Chain out = stage_model(run.project);
  out.blocks.insert(out.blocks.begin(), loop_of(*run.design.controller, run.project.target.disturbance,
                                                lowest_tracked(run.project)));
  return out;
}

}  // namespace bodesmith::project
