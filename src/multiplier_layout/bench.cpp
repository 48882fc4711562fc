#include "multiplier_layout/bench.hpp"

#include <algorithm>

#include "circuit/parts/summing_amplifier.hpp"

namespace bodesmith::multiplier_layout {

Bench::Bench(const Layout& layout) : layout_(layout) {
  const size_t gains = layout.amplitude ? layout.branches.size() : 0;
  multiplier.resize(layout.multipliers.size());
  resistor.resize(layout.parts.size(), 0.0);
  offset.resize(layout.sums.size() + 1 + gains, 0.0);
  names_ = {{"0", 0}, {"x", 1}};
  for (const Multiplier& m : layout.multipliers)
    products_.push_back({node(m.x), node(m.y), node(m.z), node(m.out)});
  for (const Sum& sum : layout.sums) {
    std::vector<int> nodes;
    for (const Sum::Term& term : sum.terms) nodes.push_back(node(term.node));
    terms_.push_back(nodes);
    sum_out_.push_back(node(layout.op(sum.opamp).out));
  }
  for (const Branch& branch : layout.branches) branch_out_.push_back(node(branch.out));
}

int Bench::node(const std::string& name) {
  return names_.emplace(name, static_cast<int>(names_.size())).first->second;
}

double Bench::ohm(int part) const {
  return layout_.part(part).realised * (1.0 + resistor[static_cast<size_t>(part)]);
}

double Bench::multiply(const MultiplierDeviation& off, double x, double y, double z) const {
  return (x + off.x) * (y + off.y) / (layout_.multiplier.scale_v * (1.0 + off.scale)) * (1.0 + off.bend) + z +
         off.w;
}

std::vector<double> Bench::gains(const Sum& sum, double& noise_gain) const {
  circuit::SummingResistors r;
  std::vector<double> signs;
  double minus = 0.0;
  r.feedback = ohm(sum.feedback);
  for (const Sum::Term& term : sum.terms) {
    r.weights.push_back(ohm(term.part));
    signs.push_back(term.at_plus ? 1.0 : -1.0);
    if (!term.at_plus) minus += 1.0 / r.weights.back();
  }
  if (sum.balance >= 0) {
    r.balance = ohm(sum.balance);
    r.balance_at_plus = layout_.part(sum.balance).from == layout_.op(sum.opamp).plus;
    if (!r.balance_at_plus) minus += 1.0 / r.balance;
  }
  noise_gain = 1.0 + minus * r.feedback;
  return circuit::summing_gains(r, signs);
}

std::vector<double> Bench::run(size_t branch, const std::vector<double>& x,
                               std::optional<double> control) const {
  std::vector<std::vector<double>> weights;
  std::vector<double> rest;
  for (size_t s = 0; s < layout_.sums.size(); ++s) {
    double noise_gain = 1.0;
    weights.push_back(gains(layout_.sums[s], noise_gain));
    rest.push_back(offset[s] * noise_gain);
  }
  const Branch& wanted = layout_.branches[branch];
  const double input = ohm(layout_.output_input) +
                       (layout_.switched() ? layout_.analog_switch.on_ohm * (1.0 + switch_relative) : 0.0);
  const double gain = ohm(control ? layout_.amplitude->output_feedback : layout_.output_feedback) / input;
  std::vector<double> v(names_.size(), 0.0), out;
  const auto product = [&](size_t i) {
    const Product& p = products_[i];
    const auto at = [&](int n) { return v[static_cast<size_t>(n)]; };
    v[static_cast<size_t>(p.out)] = multiply(multiplier[i], at(p.x), at(p.y), at(p.z));
  };
  const size_t chains = [&] {
    size_t first = layout_.multipliers.size();
    for (const Branch& b : layout_.branches) {
      for (const int index : b.multipliers) first = std::min(first, static_cast<size_t>(index));
    }
    return first;
  }();
  for (const double at : x) {
    v[1] = at;
    for (size_t i = 0; i < chains; ++i) product(i);
    for (const int index : wanted.sums) {
      const size_t s = static_cast<size_t>(index);
      double sum = rest[s];
      for (size_t k = 0; k < weights[s].size(); ++k)
        sum += weights[s][k] * v[static_cast<size_t>(terms_[s][k])];
      v[static_cast<size_t>(sum_out_[s])] = sum;
    }
    for (const int index : wanted.multipliers) product(static_cast<size_t>(index));
    double end = v[static_cast<size_t>(branch_out_[branch])];
    if (control) end = multiply(multiplier[layout_.generator_multipliers() + branch], end, *control, 0.0);
    out.push_back(-gain * end + offset[layout_.sums.size()] * (1.0 + gain));
  }
  return out;
}

std::vector<double> Bench::curve(size_t branch, const std::vector<double>& x) const {
  return run(branch, x, std::nullopt);
}

std::vector<double> Bench::curve(size_t branch, const std::vector<double>& x, double alpha) const {
  return run(branch, x, control_v(branch, alpha));
}

double Bench::control_v(size_t branch, double alpha) const {
  const AmplitudeControl& amplitude = *layout_.amplitude;
  std::map<std::string, double> v = {{"vr", -1.0}};
  for (const AmplitudeControl::Rectifier& r : amplitude.rectifiers) {
    const double current = alpha / ohm(r.input) - 1.0 / ohm(r.reference);
    v[r.node] = -std::max(0.0, current * ohm(r.feedback));
  }
  const auto sum = [&](const Sum& one, double off) {
    double noise_gain = 1.0, out = 0.0;
    const std::vector<double> weights = gains(one, noise_gain);
    for (size_t k = 0; k < weights.size(); ++k) out += weights[k] * v[one.terms[k].node];
    return out + off * noise_gain;
  };
  const AmplitudeControl::Control& control = amplitude.controls[branch];
  if (control.negative) v[layout_.op(control.negative->opamp).out] = sum(*control.negative, 0.0);
  return sum(control.sum, offset[layout_.sums.size() + 1 + branch]);
}

}  // namespace bodesmith::multiplier_layout
