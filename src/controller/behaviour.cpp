#include "controller/behaviour.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.hpp"
#include "base/text.hpp"
#include "multiplier_layout/slope_detector.hpp"

namespace bodesmith::controller {
namespace {

constexpr int kNewtonSteps = 8;

double rectified(double v, bool positive) {
  return positive ? std::max(0.0, -v) : -std::max(0.0, v);
}

}  // namespace

Behaviour::Behaviour(const AnalogController& controller)
    : off(Deviations::none(controller)), controller_(controller) {}

/// Superposition over an op-amp with terms of both signs, its offset amplified by the noise gain.
double Behaviour::sum_value(const Sum& sum, const std::map<std::string, double>& node) const {
  const AnalogController& c = controller_;
  double plus = 0.0, plus_v = 0.0, minus = 0.0, minus_v = 0.0;
  for (const Term& term : sum.terms) {
    const double ohm = off.value(c, term.part) + term.series_ohm * (1.0 + off.switch_relative);
    const double volts = node.at(term.node);
    (term.at_plus ? plus : minus) += 1.0 / ohm;
    (term.at_plus ? plus_v : minus_v) += volts / ohm;
  }
  if (sum.balance >= 0) (sum.balance_at_plus ? plus : minus) += 1.0 / off.value(c, sum.balance);
  const double feedback = off.value(c, sum.feedback);
  const double at_plus = (plus > 0.0 ? plus_v / plus : 0.0) + off.offset(sum.opamp);
  return at_plus * (1.0 + minus * feedback) - minus_v * feedback;
}

double Behaviour::multiply(int multiplier, double x, double y, double z) const {
  const schematic::MultiplierDeviation& m = off.multiplier[static_cast<std::size_t>(multiplier)];
  return (x + m.x) * (y + m.y) / (controller_.multiplier.scale_v * (1.0 + m.scale)) * (1.0 + m.bend) + z +
         m.w;
}

/// Through four points: the powers and the sum make a cubic of the argument whatever is off (offsets at the second
/// multiplier included).
Behaviour::Cubic Behaviour::branch_cubic(const Pass& pass, const BranchPath& path) const {
  Cubic out;
  if (path.sum < 0) return out;
  double value[4];
  for (int i = 0; i < 4; ++i) {
    const double x = i / 3.0;
    std::map<std::string, double> node;
    node[pass.x] = x;
    double scaled = x;
    if (pass.divider[0] >= 0) {
      const double upper = off.value(controller_, pass.divider[0]),
                   lower = off.value(controller_, pass.divider[1]);
      scaled = x * lower / (lower + upper);
    }
    const auto index = [](int m) { return static_cast<std::size_t>(m); };
    double square = 0.0;
    if (pass.square >= 0) {
      square = multiply(pass.square, scaled, scaled, 0.0);
      node[controller_.multipliers[index(pass.square)].out] = square;
    }
    if (pass.cube >= 0)
      node[controller_.multipliers[index(pass.cube)].out] = multiply(pass.cube, square, scaled, 0.0);
    value[i] = sum_value(controller_.sum(path.sum), node);
  }
  // Newton's divided differences at 0, 1/3, 2/3, 1.
  const double d1 = 3.0 * (value[1] - value[0]), d2 = 4.5 * (value[2] - 2.0 * value[1] + value[0]),
               d3 = 4.5 * (value[3] - 3.0 * value[2] + 3.0 * value[1] - value[0]);
  out.c[0] = value[0];
  out.c[1] = d1 - d2 / 3.0 + 2.0 * d3 / 9.0;
  out.c[2] = d2 - d3;
  out.c[3] = d3;
  return out;
}

Behaviour::BuiltPass Behaviour::build(const Pass& pass) const {
  BuiltPass out;
  const Sum& sum = controller_.sum(pass.output);
  std::map<std::string, double> node;
  for (const Term& term : sum.terms) node[term.node] = 0.0;
  out.offset = sum_value(sum, node);
  for (const Term& term : sum.terms) {
    node[term.node] = 1.0;
    (term.at_plus ? out.reference : out.load) = sum_value(sum, node) - out.offset;
    node[term.node] = 0.0;
  }
  for (const std::size_t b : {0u, 1u}) out.sum[b] = branch_cubic(pass, pass.branch[b]);
  return out;
}

double Behaviour::node(const BuiltPass& built, const Pass& pass, int b, double x, double control) const {
  return gained(pass, b, built.sum[b].value(x), control);
}

double Behaviour::gained(const Pass& pass, int b, double sum, double control) const {
  const int gain = pass.branch[static_cast<std::size_t>(b)].gain;
  return gain < 0 ? sum : multiply(gain, sum, control, sum);
}

double Behaviour::noise_gain(const Sum& sum) const {
  double siemens = 0.0;
  for (const Term& term : sum.terms) {
    if (!term.at_plus) siemens += 1.0 / (off.value(controller_, term.part) + term.series_ohm);
  }
  if (sum.balance >= 0 && !sum.balance_at_plus) siemens += 1.0 / off.value(controller_, sum.balance);
  return 1.0 + siemens * off.value(controller_, sum.feedback);
}

double Behaviour::subtracted(Disturbance::Branch which, double x, double control) const {
  const Pass& pass = controller_.passes.front();
  const BuiltPass built = build(pass);
  return -built.load * node(built, pass, which == Disturbance::Branch::ascending ? 0 : 1, x, control);
}

double Behaviour::control_v(Disturbance::Branch which, double slope) const {
  const int control = controller_.rate[which == Disturbance::Branch::ascending ? 0 : 1].control;
  if (control < 0) return 0.0;
  std::map<std::string, double> nodes;
  nodes["sn"] = -slope;
  for (std::size_t i = 0; i < controller_.sources.size(); ++i) {
    const schematic::Source& one = controller_.sources[i];
    nodes[one.node] = one.volts * (1.0 + off.source[i]);
  }
  if (controller_.low_reference) {
    const AnalogController::LowReference& low = *controller_.low_reference;
    const double upper = off.value(controller_, low.divider[0]),
                 lower = off.value(controller_, low.divider[1]);
    nodes["vl"] = nodes.at("vr") * lower / (lower + upper) + off.offset(low.opamp);
  }
  for (const Rectifier& one : controller_.rectifiers) {
    double current = 0.0, siemens = 0.0;
    for (const Term& term : one.terms) {
      const double ohm = off.value(controller_, term.part);
      current += nodes.at(term.node) / ohm;
      siemens += 1.0 / ohm;
    }
    const double feedback = off.value(controller_, one.feedback), offset = off.offset(one.opamp);
    const double conducting = (current - offset * siemens) * feedback - offset;  // minus the node's voltage
    nodes[one.node] = one.positive ? std::max(-conducting, offset) : std::min(-conducting, offset);
  }
  for (const int sum :
       {controller_.rate[which == Disturbance::Branch::ascending ? 0 : 1].inverted, control}) {
    if (sum >= 0)
      nodes[controller_.op(controller_.sum(sum).opamp).out] = sum_value(controller_.sum(sum), nodes);
  }
  return nodes.at(controller_.op(controller_.sum(control).opamp).out);
}

double Behaviour::slope_v(double slope) const {
  if (!controller_.slope) return 0.0;
  const AnalogController::SlopeMeter& m = *controller_.slope;
  const double swing = controller_.opamp.swing_v;
  std::map<std::string, double> nodes;
  const double w = -off.value(controller_, m.gain) * off.value(controller_, m.differentiates) * slope;
  nodes["w0"] = std::clamp(w + off.offset(m.opamp), -swing, swing);
  const double input = off.value(controller_, m.half_wave.terms[0].part),
               feedback = off.value(controller_, m.half_wave.feedback),
               offset = off.offset(m.half_wave.opamp);
  nodes[m.half_wave.node] = rectified((nodes["w0"] - offset) * feedback / input - offset, true);
  return -std::clamp(sum_value(controller_.sum(m.full_wave), nodes), -swing, swing);
}

double Behaviour::rate_gain(Disturbance::Branch which, Hertz operating) const {
  const int b = which == Disturbance::Branch::ascending ? 0 : 1;
  const double at_rest = controller_.rate[b].at_rest;
  const double slope = 2.0 * controller_.reference_stroke * operating.value;
  // Either way of the triangle alike but for offsets; the branch's own way counts.
  const double control = control_v(which, slope_v(b == 0 ? slope : -slope));
  return at_rest * (1.0 + control / controller_.multiplier.scale_v);
}

/// The smoothed slope meter over one repeat, in steady state: exact for a slope that is constant over a sample.
std::vector<double> Behaviour::slope_signal(const tracking::Reference& reference, Hertz operating,
                                            std::size_t samples) const {
  std::vector<double> out(samples, 0.0);
  if (!controller_.slope) return out;
  const Sum& sum = controller_.sum(controller_.slope->full_wave);
  const double repeat = static_cast<double>(reference.periods()) / operating.value;
  const double tau = off.value(controller_, sum.smoothing) * off.value(controller_, sum.feedback);
  const double keep = std::exp(-repeat / static_cast<double>(samples) / tau);
  std::vector<double> raw;
  for (std::size_t k = 0; k < samples; ++k) {
    const double theta = (static_cast<double>(k) + 0.5) / static_cast<double>(samples);
    raw.push_back(slope_v(reference.slope(theta, reference.piece(theta)) / repeat));
  }
  // The state with which a repeat ends as it began.
  double state = 0.0, power = 1.0;
  for (const double one : raw) {
    state = keep * state + (1.0 - keep) * one;
    power *= keep;
  }
  state /= 1.0 - power;
  for (std::size_t k = 0; k < samples; ++k) {
    out[k] = state;
    state = keep * state + (1.0 - keep) * raw[k];
  }
  return out;
}

double Behaviour::solve(const BuiltPass& built, const Pass& pass, int b, double r, double control,
                        double guess) const {
  const double rest = built.reference * r + built.offset;
  if (pass.x != pass.out) return rest + built.load * node(built, pass, b, pass.x == "r" ? r : guess, control);
  double v = guess;
  const double step = 1e-6;
  for (int i = 0; i < kNewtonSteps; ++i) {
    const double off_by = v - rest - built.load * node(built, pass, b, v, control);
    const double more = v + step - rest - built.load * node(built, pass, b, v + step, control);
    const double change = off_by * step / (more - off_by);
    v -= change;
    if (std::abs(change) < 1e-13) break;
  }
  return v;
}

Settled Behaviour::run(const tracking::Reference& reference, Hertz operating, std::size_t samples) const {
  const double repeat = static_cast<double>(reference.periods()) / operating.value;
  Settled out{reference, operating, repeat / static_cast<double>(samples), {}, {}, {}, 0.0};
  std::vector<BuiltPass> built;
  for (const Pass& pass : controller_.passes) built.push_back(build(pass));
  const std::vector<double> slope = slope_signal(reference, operating, samples);
  const double late = (switch_delay_s + off.switch_delay_s) / repeat;
  double known_slope = -1.0, control[2] = {0.0, 0.0};
  double v = 0.0;
  for (std::size_t k = 0; k < samples; ++k) {
    const double theta = static_cast<double>(k) / static_cast<double>(samples);
    const double seen = theta - late - std::floor(theta - late);
    const int b = tracking::Reference::rises(reference.piece(seen)) ? 0 : 1;
    if (std::abs(slope[k] - known_slope) > 1e-9) {
      known_slope = slope[k];
      control[0] = control_v(Disturbance::Branch::ascending, known_slope);
      control[1] = control_v(Disturbance::Branch::descending, known_slope);
    }
    const double r = reference.value(theta);
    double x = r;
    for (std::size_t i = 0; i < built.size(); ++i) {
      const Pass& pass = controller_.passes[i];
      x = solve(built[i], pass, b, r, control[b], pass.x == pass.out ? v : x);
    }
    v = x;
    out.r.push_back(r);
    out.v.push_back(v);
  }
  return out;
}

double generator_error_percent(const AnalogController& controller) {
  constexpr int kPoints = 200;
  const Behaviour built(controller);
  std::vector<Hertz> at = controller.tracked;
  if (controller.curve) {
    const std::vector<Hertz>& corner = controller.curve->corner;
    for (std::size_t i = 0; i < corner.size(); ++i) {
      at.push_back(corner[i]);
      if (i > 0) at.push_back(Hertz{std::sqrt(corner[i - 1].value * corner[i].value)});
    }
  }
  if (at.empty()) at.push_back(Hertz{1.0});
  double worst = 0.0;
  for (const auto which : {Disturbance::Branch::ascending, Disturbance::Branch::descending}) {
    for (const Hertz f : at) {
      const double control =
          built.control_v(which, built.slope_v(2.0 * controller.reference_stroke * f.value));
      const double wanted = controller.rated_gain(which, f);
      for (int i = 0; i <= kPoints; ++i) {
        const double x = std::max(controller.loop.greatest_drive, 1.0) * i / kPoints;
        worst = std::max(worst, std::abs(built.subtracted(which, x, control) -
                                         wanted * controller.disturbance.value(which, x)));
      }
    }
  }
  return 100.0 * worst;
}

double switch_delay_s(const AnalogController& controller, const tracking::Reference& reference,
                      Hertz operating) {
  const multiplier_layout::SlopeDetector detector(
      schematic::subset(
          controller, [&](std::size_t group) { return controller.purpose_of(group) == Purpose::slope_sign; }),
      "r");
  const double repeat = static_cast<double>(reference.periods()) / operating.value;
  const double turn = reference.turns().back(), next = reference.turns()[1];
  const std::optional<double> delay = detector.delay_s(
      [&](double t) {
        const double theta = t / repeat;
        return reference.value(theta - std::floor(theta));
      },
      turn * repeat, repeat, (1.0 + next) * repeat);
  if (!delay) {
    throw InputError(fmt::format("a {} of {} Hz is too slow for the slope detector",
                                 to_string(reference.shape()), rounded_text(operating.value)));
  }
  return *delay + controller.analog_switch.on_delay_s;
}

}  // namespace bodesmith::controller
