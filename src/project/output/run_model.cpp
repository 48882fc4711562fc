#include "project/output/run_model.hpp"

#include <algorithm>
#include <string>
#include <tuple>
#include <vector>

#include "base/hertz_values.hpp"
#include "chain/registry.hpp"
#include "chain/sections_chain.hpp"
#include "synthesis/controller/as_built.hpp"
#include "synthesis/generator/at_rest.hpp"
#include "synthesis/generator/part_errors.hpp"

namespace bodesmith::project {
namespace {

using Branch = Disturbance::Branch;
using chain::Block;
using chain::make_block;
using chain::PartChange;

/// Departure, relative, at which what a part does is worked out; the form that it has goes far beyond.
constexpr double kRelative = 0.05;

Block called(Block block, const char* name) {
  block.part = name;
  return block;
}

/// `stroke`: for which amplitude gains stand, where there are some.
Block loop_of(const generator::DisturbanceCircuit& controller, const Disturbance& disturbance,
              Hertz operating, const schematic::Deviations& off, double stroke = 1.0) {
  generator::BuiltGenerator built(controller, off);
  const double alpha = controller.stroke ? stroke : 1.0;
  built.set_stroke(alpha);
  const std::vector<double> frequency = hertz_values(disturbance.rate.frequency);
  Block out = make_block("loop");
  for (const auto& [which, list, constant, rates] :
       {std::tuple{Branch::ascending, "ascending", "constant_ascending", "rate_ascending"},
        {Branch::descending, "descending", "constant_descending", "rate_descending"}}) {
    // A cubic through four of its values: what the powers, sums and gains with their parts make.
    built.set_rate(operating);
    const double gain = built.rate_gain(which);
    const std::vector<double> c = cubic_of(
        [&, which = which](double x) { return built.subtracted(which, x) / gain; });  // of the stroke
    out.set(list, std::vector<double>{c[1] / alpha, c[2] / (alpha * alpha), c[3] / (alpha * alpha * alpha)});
    out.set(constant, c[0] * gain);
    std::vector<double> gains;
    for (const Hertz f : disturbance.rate.frequency) {
      built.set_rate(f);
      gains.push_back(built.rate_gain(which));
    }
    out.set(rates, gains);
  }
  out.set("reference_gain", built.reference_gain());
  out.set("rate_frequency_hz", frequency).set("operating_hz", operating.value);
  out.set("passes", controller.form == generator::Form::self_fed   ? 0.0
                    : controller.form == generator::Form::two_pass ? 2.0
                                                                   : 1.0);
  return called(std::move(out), "controller");
}

/// What each part does to `loop`, which is the block without departures; those that do nothing at rest are left out.
std::vector<PartChange> part_changes(const Run& run, const Block& loop, Hertz operating) {
  const generator::DisturbanceCircuit& controller = *run.design.controller;
  const auto causes = generator::causes_of(controller, run.project.controller.errors);
  std::vector<double> values(causes.size(), 0.0);
  std::vector<PartChange> out;
  for (std::size_t i = 0; i < causes.size(); ++i) {
    const generator::Cause& cause = causes[i];
    if (cause.group == "op-amp speed" || cause.group == "switch") continue;
    const bool volts = cause.group.ends_with("offsets");
    const double departure = volts ? cause.departure.limit() : kRelative;
    const auto with = [&](double value) {
      values[i] = value;
      return loop_of(controller, run.project.target.disturbance, operating,
                     generator::copy_of(controller, causes, values).off);
    };
    const Block above = with(departure);
    const Block below = with(-departure);
    values[i] = 0.0;
    const double unit = volts ? 1.0 : 100.0;
    PartChange one{cause.name.substr(0, cause.name.find(", tolerance")), volts ? "v" : "percent",
                   unit * cause.departure.limit()};
    one.add_differences(loop, unit * departure, above, below);
    if (!one.entries.empty()) out.push_back(std::move(one));
  }
  return out;
}

class ControllerAtRest final : public tracking::BuiltController {
 public:
  ControllerAtRest(const Disturbance& disturbance,
                   std::shared_ptr<const generator::DisturbanceCircuit> controller)
      : disturbance_(disturbance), controller_(std::move(controller)) {}

  std::string key() const override { return "controller_at_rest"; }
  std::string name() const override { return "analog controller (closed form, at rest)"; }
  int part_count() const override {
    return generator::CircuitController(controller_, std::nullopt).part_count();
  }
  tracking::DriveWaveform drive(const tracking::Reference& reference, Hertz operating) const override {
    const Block loop = loop_of(*controller_, disturbance_, operating,
                               schematic::Deviations::none(*controller_), reference.alpha());
    chain::Kernel kernel = loop.kernel();
    chain::MemoryKernel& steps = *std::get<std::unique_ptr<chain::MemoryKernel>>(kernel);
    const std::size_t count = kSamples * reference.periods();
    const std::vector<double> r = reference.samples(count);
    tracking::DriveWaveform out;
    out.step_s = 1.0 / (operating.value * static_cast<double>(kSamples));
    steps.reset(r.back(), true);
    for (const double one : r) out.v.push_back(steps.step(one, out.step_s));
    return out;
  }

 private:
  static constexpr std::size_t kSamples = 2048;  ///< to a period, as the netlist's runs have

  const Disturbance& disturbance_;
  std::shared_ptr<const generator::DisturbanceCircuit> controller_;
};

}  // namespace

std::unique_ptr<tracking::BuiltController> controller_at_rest(
    const Project& project, std::shared_ptr<const generator::DisturbanceCircuit> controller) {
  return std::make_unique<ControllerAtRest>(project.target.disturbance, std::move(controller));
}

Hertz lowest_tracked(const Project& project) {
  return *std::ranges::min_element(project.track.frequency);
}

chain::Chain stage_model(const Project& project, Hertz operating) {
  chain::Chain out;
  const Project::Plant& plant = *project.plant;
  if (plant.amplifier_corner) {
    out.blocks.push_back(
        called(make_block("lowpass").set("corner_hz", plant.amplifier_corner->value), "amplifier"));
    out.blocks.back().free("corner_hz");
  }
  out.blocks.push_back(chain::stage_block(project.target.disturbance, operating));
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

std::optional<chain::Chain> built_model(const Run& run) {
  if (!run.design.controller) return std::nullopt;
  const Hertz operating = lowest_tracked(run.project);
  const generator::DisturbanceCircuit& controller = *run.design.controller;
  Block loop =
      loop_of(controller, run.project.target.disturbance, operating, schematic::Deviations::none(controller));
  loop.parts = std::make_shared<const std::vector<PartChange>>(part_changes(run, loop, operating));
  chain::Chain out = stage_model(run.project, operating);
  out.blocks.insert(out.blocks.begin(), std::move(loop));
  return out;
}

}  // namespace bodesmith::project
