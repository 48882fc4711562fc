#include "synthesis/generator/at_rest.hpp"

#include <algorithm>
#include <cmath>

namespace bodesmith::generator {
namespace {

std::string control_node(const DisturbanceCircuit& c, const BranchGain& gain) {
  return gain.control < 0 ? "" : c.op(gain.control).out;
}

schematic::RestOrder generator_order(const DisturbanceCircuit& c, bool cut) {
  if (c.form == Form::open) {
    return {c.generator(),
            c.amplitude ? std::vector<std::string>{"x", "amplitude"} : std::vector<std::string>{"x"}};
  }
  schematic::Netlist netlist = generator_netlist(c, cut);
  netlist.sources.clear();
  std::vector<std::string> inputs = {"r"};
  if (cut) inputs.emplace_back(kArgument);
  for (const auto which : {&Branch::rate, &Branch::amplitude}) {
    for (const Branch& b : c.branches) {
      if (const std::string node = control_node(c, b.*which); !node.empty()) inputs.push_back(node);
    }
  }
  return {netlist, inputs};
}

/// Of a controller: what the slope and the stroke make of the gains.
schematic::RestOrder rate_order(const DisturbanceCircuit& c) {
  return {schematic::subset(c,
                            [&](std::size_t group) {
                              const Purpose purpose = c.purpose_of(group);
                              return c.form != Form::open &&
                                     (purpose == Purpose::rate_curve || purpose == Purpose::rate_gain ||
                                      purpose == Purpose::amplitude);
                            }),
          {"sn", "an"}};
}

/// V(al) for a reference of that stroke: what follows it adds its offsets.
double stroke_v(const DisturbanceCircuit& c, double alpha, const Deviations& off) {
  double out = std::max(alpha, c.stroke->least);
  for (const int one : c.stroke->follow) out += off.offset(one);
  return out;
}

/// V(quotient) = gain V(node) + offset, from (z + x)(al + y)(1 + bend)/(U (1 + scale)) + w = share V(node) + offset of the op-amp.
struct Quotient {
  double gain = 1.0, offset = 0.0;
};
Quotient quotient_of(const DisturbanceCircuit& c, const std::string& node, double alpha,
                     const Deviations& off) {
  if (!c.stroke) return {};
  const DisturbanceCircuit::Stroke::Division& d = c.stroke->divisions.at(node);
  const schematic::MultiplierDeviation& m = off.multiplier[static_cast<std::size_t>(d.multiplier)];
  const double below = off.value(c, d.below), share = below / (below + off.value(c, d.above));
  const double by =
      c.multiplier.scale_v * (1.0 + m.scale) / ((1.0 + m.bend) * (stroke_v(c, alpha, off) + m.y));
  return {share * by, (off.offset(d.opamp) - m.w) * by - m.x};
}

}  // namespace

SlopeMeterGains SlopeMeterGains::of(const DisturbanceCircuit& c, const Deviations& off) {
  SlopeMeterGains out;
  if (!c.slope) return out;
  const DisturbanceCircuit::SlopeMeter& m = *c.slope;
  const double input_gain = quotient_of(c, "r", 1.0, off).gain;
  out.volts = input_gain * off.value(c, m.gain) * off.value(c, m.differentiates);
  out.offset = off.offset(m.opamp);
  out.lag1_s = off.value(c, m.damping) * off.value(c, m.differentiates);
  out.lag2_s = off.value(c, m.gain) * off.value(c, m.limits);
  out.half_gain = off.value(c, m.half_wave_feedback) / off.value(c, m.half_wave_input);
  out.half_offset = off.offset(m.half_wave_opamp) * (1.0 + out.half_gain);
  const double feedback = off.value(c, m.full_wave_feedback);
  out.direct = feedback / off.value(c, m.direct);
  out.half = feedback / off.value(c, m.half);
  out.full_offset = off.offset(m.full_wave_opamp) * (1.0 + out.direct + out.half);
  const double towards = off.value(c, m.half), own = off.value(c, m.half_wave_feedback);
  out.half_rest =
      (off.offset(m.half_wave_opamp) * towards + off.offset(m.full_wave_opamp) * own) / (towards + own);
  out.smoothing_s = off.value(c, m.smoothing) * feedback;
  return out;
}

double SlopeMeterGains::output_v(double slope) const {
  const double w = -volts * slope + offset, rectified = std::max(half_rest, -w * half_gain + half_offset);
  return -(w * direct + rectified * half) + full_offset;
}

RestWiring::RestWiring(const DisturbanceCircuit& c, bool cut)
    : circuit(c),
      argument_is_given(cut || c.form == Form::self_fed || c.form == Form::open),
      rate(rate_order(c)),
      generator(generator_order(c, argument_is_given)) {}

AtRest::AtRest(const RestWiring& wiring, const Deviations& off, const AtRest* like)
    : wiring_(&wiring),
      off_(off),
      rate_(wiring.rate, off.of_part(wiring.rate.netlist(), wiring.circuit),
            like != nullptr ? &like->rate_ : nullptr),
      generator_(wiring.generator, off.of_part(wiring.generator.netlist(), wiring.circuit),
                 like != nullptr ? &like->generator_ : nullptr),
      branches_(wiring.circuit.branches.size()) {
  const DisturbanceCircuit& c = wiring.circuit;
  drive_ = wiring.generator.node(c.passes.back().out);
  if (c.form == Form::open) {
    argument_ = wiring.generator.node("x");
    if (c.amplitude) stroke_ = wiring.generator.node("amplitude");
    set_stroke(1.0);
    return;
  }
  slope_ = wiring.rate.node("sn");
  stroke_ = wiring.rate.node("an");
  reference_ = wiring.generator.node("r");
  if (wiring.argument_is_given) argument_ = wiring.generator.node(kArgument);
  for (std::size_t b = 0; b < branches_.size(); ++b) {
    for (const auto& [gain, control] : {std::pair{&c.branches[b].rate, &branches_[b].rate},
                                        {&c.branches[b].amplitude, &branches_[b].amplitude}}) {
      const std::string node = control_node(c, *gain);
      if (node.empty()) continue;
      control->made = wiring.rate.node(node);
      control->read = wiring.generator.node(node);
    }
  }
  set_slope(0.0);
  set_stroke(1.0);
  const double at_one = made(1.0, 0.0, 0);
  reference_gain_ = at_one - made(0.0, 0.0, 0);
}

void AtRest::follow(Control Controls::*which) {
  rate_.settle(0);
  for (Controls& b : branches_) {
    if (Control& one = b.*which; one.made >= 0) one.volts = rate_.volts(one.made);
  }
}

void AtRest::set_slope(double volts) {
  rate_.set(slope_, volts);
  follow(&Controls::rate);
}

void AtRest::set_stroke(double alpha) {
  const DisturbanceCircuit& c = wiring_->circuit;
  if (c.form == Form::open) {
    if (c.amplitude) generator_.set(stroke_, alpha);
    return;
  }
  alpha_ = alpha;
  double inverted = -1.0;
  if (c.stroke) {
    const double ratio = off_.value(c, c.stroke->inverter.feedback) / off_.value(c, c.stroke->inverter.input);
    inverted = -ratio * stroke_v(c, alpha, off_) + (1.0 + ratio) * off_.offset(c.stroke->inverter.opamp);
    const Quotient argument = quotient_of(c, c.passes.back().from, alpha, off_);
    argument_gain_ = argument.gain;
    argument_offset_ = argument.offset;
  }
  rate_.set(stroke_, inverted);
  follow(&Controls::amplitude);
}

double AtRest::made(double r, double argument, std::size_t branch) {
  if (reference_ >= 0) generator_.set(reference_, r);
  if (argument_ >= 0) generator_.set(argument_, argument_gain_ * alpha_ * argument + argument_offset_);
  for (const Controls& b : branches_) {
    for (const Control* one : {&b.rate, &b.amplitude}) {
      if (one->read >= 0) generator_.set(one->read, one->volts);
    }
  }
  generator_.settle(static_cast<int>(branch));
  return generator_.volts(drive_);
}

std::vector<double> curve(AtRest at, std::size_t branch, const std::vector<double>& x, double alpha) {
  at.set_stroke(alpha);
  std::vector<double> d;
  for (const double one : x) d.push_back(at.made(0.0, one, branch));
  return d;
}

double AtRest::noise_gain(int opamp) {
  const std::string& name = wiring_->circuit.op(opamp).name;
  const std::vector<OpAmp>& all = wiring_->generator.netlist().opamps;
  const auto at = std::ranges::find(all, name, &OpAmp::name);
  return generator_.noise_gain(static_cast<std::size_t>(at - all.begin()));
}

BuiltGenerator::BuiltGenerator(const DisturbanceCircuit& controller, const Deviations& off)
    : controller_(controller),
      meter_(SlopeMeterGains::of(controller, off)),
      wiring_(controller, true),
      rest_(wiring_, off) {}

void BuiltGenerator::set_rate(Hertz operating) {
  rest_.set_slope(meter_.output_v(2.0 * controller_.reference_stroke * operating.value));
}

double BuiltGenerator::subtracted(Disturbance::Branch which, double x) {
  return -rest_.made(0.0, x, branch_index(which));
}

double BuiltGenerator::rate_gain(Disturbance::Branch which) const {
  const std::size_t b = branch_index(which);
  return controller_.branches[b].rate.at_rest * (1.0 + rest_.control_v(b) / controller_.multiplier.scale_v);
}

double generator_error_percent(const DisturbanceCircuit& controller) {
  constexpr int kPoints = 200;
  BuiltGenerator built(controller);
  std::vector<Hertz> at = controller.tracked;
  if (controller.curve) {
    const std::vector<Hertz>& corner = controller.curve->corner;
    for (std::size_t i = 0; i < corner.size(); ++i) {
      at.push_back(corner[i]);
      if (i > 0) at.push_back(Hertz{std::sqrt(corner[i - 1].value * corner[i].value)});
    }
  }
  if (at.empty()) at.push_back(Hertz{1.0});
  std::vector<double> strokes = {1.0};
  if (controller.stroke) {
    strokes = {std::max(controller.stroke->least, controller.disturbance.amplitude.alpha.front())};
    for (const double alpha : controller.disturbance.amplitude.alpha) {
      if (alpha <= strokes.back()) continue;
      strokes.push_back(0.5 * (strokes.back() + alpha));
      strokes.push_back(alpha);
    }
  }
  double worst = 0.0;
  for (const Hertz f : at) {
    built.set_rate(f);
    for (const double alpha : strokes) {
      built.set_stroke(alpha);
      for (const auto which : kBranches) {
        const double wanted = controller.rated_gain(which, f) * controller.amplitude_gain(which, alpha);
        for (int i = 0; i <= kPoints; ++i) {
          const double x = std::max(controller.loop.greatest_drive, 1.0) * i / kPoints;
          worst = std::max(
              worst, std::abs(built.subtracted(which, x) - wanted * controller.disturbance.value(which, x)));
        }
      }
    }
  }
  return 100.0 * worst;
}

}  // namespace bodesmith::generator
