#include "part_errors/rest_point.hpp"

#include <algorithm>

namespace bodesmith::part_errors {

using controller::AnalogController;
using schematic::Deviations;
using Kind = Wiring::Element::Kind;

RestPoint::RestPoint(const Wiring& wiring, const Deviations& off) : wiring_(wiring) {
  const AnalogController& c = wiring.controller();
  v_.assign(wiring.nodes(), 0.0);
  noise_gain_.assign(c.sums.size(), 1.0);
  for (std::size_t i = 0; i < c.sources.size(); ++i) {
    const double relative = off.source[i];
    const int node = wiring.node(c.sources[i].node);
    if (node >= 0) v_[static_cast<std::size_t>(node)] = c.sources[i].volts * (1.0 + relative);
  }
  for (const Wiring::Element& e : wiring.rate()) rate_.push_back(step_of(e, off));
  for (const Wiring::Element& e : wiring.generator()) generator_.push_back(step_of(e, off));
  set_slope(0.0);
  const double at_one = made(1.0, 0.0, true);
  reference_gain_ = at_one - made(0.0, 0.0, true);
}

/// out = v+ (1 + Rf sum G-) - sum Rf/Rk v_k, v+ = sum Gk v_k/sum G+ + offset.
void RestPoint::sum_step(Step& step, const Wiring::Element& element, const Deviations& off) {
  const AnalogController& c = wiring_.controller();
  const bool rectifies = element.kind == Kind::rectifier;
  const auto i = static_cast<std::size_t>(element.index);
  const std::vector<controller::Term>& terms = rectifies ? c.rectifiers[i].terms : c.sums[i].terms;
  const double feedback = off.value(c, rectifies ? c.rectifiers[i].feedback : c.sums[i].feedback);
  const int opamp = rectifies ? c.rectifiers[i].opamp : c.sums[i].opamp;
  double minus = 0.0, plus = 0.0;
  std::vector<double> conductance;
  for (const controller::Term& term : terms) {
    conductance.push_back(1.0 / (off.value(c, term.part) + term.series_ohm * (1.0 + off.switch_relative)));
    (term.at_plus ? plus : minus) += conductance.back();
  }
  if (!rectifies && c.sums[i].balance >= 0) {
    (c.sums[i].balance_at_plus ? plus : minus) += 1.0 / off.value(c, c.sums[i].balance);
  }
  const double noise_gain = 1.0 + feedback * minus;
  for (std::size_t k = 0; k < terms.size(); ++k) {
    gain_.push_back(terms[k].at_plus ? conductance[k] / plus * noise_gain : -conductance[k] * feedback);
  }
  step.constant = off.offset(opamp) * noise_gain;
  if (rectifies) {
    step.positive = c.rectifiers[i].positive;
  } else {
    noise_gain_[i] = noise_gain;
  }
}

RestPoint::Step RestPoint::step_of(const Wiring::Element& element, const Deviations& off) {
  const AnalogController& c = wiring_.controller();
  Step step;
  step.kind = element.kind;
  step.out = element.out;
  step.first = in_.size();
  step.count = element.in.size();
  in_.insert(in_.end(), element.in.begin(), element.in.end());
  switch (element.kind) {
    case Kind::sum:
    case Kind::rectifier:
      sum_step(step, element, off);
      break;
    case Kind::multiplier: {
      const auto i = static_cast<std::size_t>(element.index);
      const schematic::MultiplierDeviation& m = off.multiplier[i];
      step.x = m.x;
      step.y = m.y;
      step.w = m.w;
      step.per_scale = (1.0 + m.bend) / (c.multiplier.scale_v * (1.0 + m.scale));
      gain_.resize(in_.size(), 0.0);
      break;
    }
    case Kind::divider: {
      const double a = 1.0 / off.value(c, element.index), b = 1.0 / off.value(c, element.second);
      gain_.push_back(a / (a + b));
      gain_.push_back(b / (a + b));
      break;
    }
    case Kind::follower:
      step.constant = off.offset(element.index);
      gain_.push_back(1.0);
      break;
    case Kind::contact:
      gain_.resize(in_.size(), 0.0);
      break;
  }
  return step;
}

void RestPoint::run(const std::vector<Step>& steps, bool rising) {
  const auto at = [&](std::size_t place) { return v_[static_cast<std::size_t>(in_[place])]; };
  for (const Step& s : steps) {
    double out = 0.0;
    if (s.kind == Kind::multiplier) {
      out = (at(s.first) + s.x) * (at(s.first + 1) + s.y) * s.per_scale + at(s.first + 2) + s.w;
    } else if (s.kind == Kind::contact) {
      out = at(s.first + (rising ? 0 : 1));
    } else {
      out = s.constant;
      for (std::size_t k = s.first; k < s.first + s.count; ++k) out += gain_[k] * at(k);
      if (s.kind == Kind::rectifier) out = s.positive ? std::max(0.0, out) : std::min(0.0, out);
    }
    v_[static_cast<std::size_t>(s.out)] = out;
  }
}

void RestPoint::set_slope(double volts) {
  v_[Wiring::kSlope] = volts;
  run(rate_, true);
}

double RestPoint::made(double r, double v, bool rising) {
  v_[Wiring::kReference] = r;
  v_[Wiring::kDrive] = v;
  run(generator_, rising);
  return v_[Wiring::kMade];
}

double RestPoint::volts(const std::string& node) const {
  const int at = node == "v" ? Wiring::kMade : wiring_.node(node);
  return at < 0 ? 0.0 : v_[static_cast<std::size_t>(at)];
}

}  // namespace bodesmith::part_errors
