#include "synthesis/controller/at_rest.hpp"

#include <algorithm>
#include <cmath>

#include "synthesis/controller/library.hpp"

namespace bodesmith::controller {
namespace {

std::string control_node(const AnalogController& c, const BranchGain& gain) {
  return gain.control < 0 ? "" : c.op(gain.control).out;
}

schematic::RestOrder generator_order(const AnalogController& c, bool cut) {
  schematic::Netlist netlist = generator_netlist(c, cut);
  netlist.sources.clear();
  std::vector<std::string> inputs = {"r"};
  if (cut) inputs.emplace_back(kArgument);
  for (const BranchGain* gains : {c.rate, c.amplitude}) {
    for (const int b : {0, 1}) {
      if (const std::string node = control_node(c, gains[b]); !node.empty()) inputs.push_back(node);
    }
  }
  return {netlist, inputs};
}

schematic::RestOrder rate_order(const AnalogController& c) {
  return {schematic::subset(c,
                            [&](std::size_t group) {
                              const Purpose purpose = c.purpose_of(group);
                              return purpose == Purpose::rate_curve || purpose == Purpose::rate_gain ||
                                     purpose == Purpose::amplitude;
                            }),
          {"sn", "an"}};
}

/// V(al) for a reference of that stroke: what follows it adds its offsets.
double stroke_v(const AnalogController& c, double alpha, const Deviations& off) {
  double out = std::max(alpha, c.stroke->least);
  for (const int one : c.stroke->follow) out += off.offset(one);
  return out;
}

/// V(quotient) = gain V(node) + offset, from (z + x)(al + y)(1 + bend)/(U (1 + scale)) + w = share V(node) + offset of the op-amp.
struct Quotient {
  double gain = 1.0, offset = 0.0;
};
Quotient quotient_of(const AnalogController& c, const std::string& node, double alpha,
                     const Deviations& off) {
  if (!c.stroke) return {};
  const AnalogController::Stroke::Division& d = c.stroke->divisions.at(node);
  const schematic::MultiplierDeviation& m = off.multiplier[static_cast<std::size_t>(d.multiplier)];
  const double below = off.value(c, d.below), share = below / (below + off.value(c, d.above));
  const double by =
      c.multiplier.scale_v * (1.0 + m.scale) / ((1.0 + m.bend) * (stroke_v(c, alpha, off) + m.y));
  return {share * by, (off.offset(d.opamp) - m.w) * by - m.x};
}

}  // namespace

SlopeMeterGains SlopeMeterGains::of(const AnalogController& c, const Deviations& off) {
  SlopeMeterGains out;
  if (!c.slope) return out;
  const AnalogController::SlopeMeter& m = *c.slope;
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
  out.smoothing_s = off.value(c, m.smoothing) * feedback;
  return out;
}

double SlopeMeterGains::output_v(double slope) const {
  const double w = -volts * slope + offset, rectified = std::max(0.0, -w * half_gain + half_offset);
  return -(w * direct + rectified * half) + full_offset;
}

RestWiring::RestWiring(const AnalogController& c, bool cut)
    : controller(c),
      argument_is_given(cut || c.form == Form::self_fed),
      rate(rate_order(c)),
      generator(generator_order(c, argument_is_given)) {}

AtRest::AtRest(const RestWiring& wiring, const Deviations& off, const AtRest* like)
    : wiring_(&wiring),
      off_(off),
      rate_(wiring.rate, off.of_part(wiring.rate.netlist(), wiring.controller),
            like != nullptr ? &like->rate_ : nullptr),
      generator_(wiring.generator, off.of_part(wiring.generator.netlist(), wiring.controller),
                 like != nullptr ? &like->generator_ : nullptr) {
  const AnalogController& c = wiring.controller;
  slope_ = wiring.rate.node("sn");
  stroke_ = wiring.rate.node("an");
  reference_ = wiring.generator.node("r");
  drive_ = wiring.generator.node(c.passes.back().out);
  if (wiring.argument_is_given) argument_ = wiring.generator.node(kArgument);
  for (const int b : {0, 1}) {
    for (const auto& [gain, control] :
         {std::pair{&c.rate[b], &rate_control_[b]}, {&c.amplitude[b], &amplitude_control_[b]}}) {
      const std::string node = control_node(c, *gain);
      if (node.empty()) continue;
      control->made = wiring.rate.node(node);
      control->read = wiring.generator.node(node);
    }
  }
  set_slope(0.0);
  set_stroke(1.0);
  const double at_one = made(1.0, 0.0, true);
  reference_gain_ = at_one - made(0.0, 0.0, true);
}

void AtRest::follow(Control* controls) {
  rate_.settle(0);
  for (Control* one : {controls, controls + 1}) {
    if (one->made >= 0) one->volts = rate_.volts(one->made);
  }
}

void AtRest::set_slope(double volts) {
  rate_.set(slope_, volts);
  follow(rate_control_);
}

void AtRest::set_stroke(double alpha) {
  const AnalogController& c = wiring_->controller;
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
  follow(amplitude_control_);
}

double AtRest::made(double r, double argument, bool rising) {
  generator_.set(reference_, r);
  if (argument_ >= 0) generator_.set(argument_, argument_gain_ * alpha_ * argument + argument_offset_);
  for (const Control* controls : {rate_control_, amplitude_control_}) {
    for (const int b : {0, 1}) {
      if (controls[b].read >= 0) generator_.set(controls[b].read, controls[b].volts);
    }
  }
  generator_.settle(rising ? 0 : 1);
  return generator_.volts(drive_);
}

double AtRest::noise_gain(int opamp) {
  const std::string& name = wiring_->controller.op(opamp).name;
  const std::vector<OpAmp>& all = wiring_->generator.netlist().opamps;
  const auto at = std::find_if(all.begin(), all.end(), [&](const OpAmp& one) { return one.name == name; });
  return generator_.noise_gain(static_cast<std::size_t>(at - all.begin()));
}

BuiltGenerator::BuiltGenerator(const AnalogController& controller, const Deviations& off)
    : controller_(controller),
      meter_(SlopeMeterGains::of(controller, off)),
      wiring_(controller, true),
      rest_(wiring_, off) {}

void BuiltGenerator::set_rate(Hertz operating) {
  rest_.set_slope(meter_.output_v(2.0 * controller_.reference_stroke * operating.value));
}

double BuiltGenerator::subtracted(Disturbance::Branch which, double x) {
  return -rest_.made(0.0, x, which == Disturbance::Branch::ascending);
}

double BuiltGenerator::rate_gain(Disturbance::Branch which) const {
  const auto b = static_cast<int>(branch_index(which));
  return controller_.rate[b].at_rest * (1.0 + rest_.control_v(b) / controller_.multiplier.scale_v);
}

double generator_error_percent(const AnalogController& controller) {
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

}  // namespace bodesmith::controller
