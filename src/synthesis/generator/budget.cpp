#include "synthesis/generator/budget.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/text.hpp"
#include "synthesis/generator/build.hpp"

namespace bodesmith::generator {
namespace {

using schematic::Deviations;

std::vector<double> points() {
  std::vector<double> out;
  for (int i = 0; i <= 100; ++i) out.push_back(i / 100.0);
  return out;
}

double greatest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double out = 0.0;
  for (size_t i = 0; i < a.size(); ++i) out = std::max(out, std::abs(a[i] - b[i]));
  return out;
}

std::vector<MultiplierDeviation> kinds(const ErrorLimits& e) {
  return {{e.input_offset_v, 0, 0, 0, 0},
          {0, e.input_offset_v, 0, 0, 0},
          {0, 0, e.output_offset_v, 0, 0},
          {0, 0, 0, e.scale_percent / 100.0, 0},
          {0, 0, 0, 0, e.nonlinearity_percent / 100.0}};
}
const char* const kKindNames[] = {"offset of X", "offset of Y", "offset of W", "scale U", "nonlinearity"};

using Spoil = std::function<void(Deviations&)>;
/// d of a branch at all points (and amplitudes).
using Curve = std::function<std::vector<double>(const Deviations&, size_t branch)>;

Spoil offset_of(int opamp, const ErrorLimits& errors) {
  return [opamp, volts = errors.opamp_offset_v](Deviations& off) {
    off.opamp_offset_v[static_cast<std::size_t>(opamp)] = volts;
  };
}

/// Spoils one thing after the other and notes how far d moves.
class Budgeting {
 public:
  Budgeting(const Layout& layout, Curve curve) : layout_(layout), curve_(std::move(curve)) {
    const Deviations good = Deviations::none(layout);
    for (size_t b = 0; b < layout.branches.size(); ++b) good_.push_back(curve_(good, b));
  }

  void line(std::string cause, const Spoil& spoil) {
    Deviations bad = Deviations::none(layout_);
    spoil(bad);
    BudgetLine one{std::move(cause), {}};
    for (size_t b = 0; b < good_.size(); ++b)
      one.percent.push_back(100.0 * greatest_difference(curve_(bad, b), good_[b]));
    lines.push_back(std::move(one));
  }

  void multiplier(const std::string& name, size_t index, const ErrorLimits& errors) {
    const std::vector<MultiplierDeviation> all = kinds(errors);
    for (size_t i = 0; i < all.size(); ++i) {
      line(name + ", " + kKindNames[i], [&](Deviations& off) { off.multiplier[index] = all[i]; });
    }
  }

  void resistors(bool of_amplitude, const ErrorLimits& errors) {
    for (size_t i = 0; i < layout_.parts.size(); ++i) {
      const Part& part = layout_.parts[i];
      const schematic::Purpose purpose = layout_.purpose_of(part.group);
      if (part.kind != Part::Kind::resistor || purpose == schematic::Purpose::slope_sign) continue;
      const bool is_amplitude =
          purpose == schematic::Purpose::amplitude ||
          (layout_.amplitude && static_cast<int>(i) == layout_.amplitude->output_feedback);
      if (is_amplitude != of_amplitude) continue;
      line(part.name + ", tolerance",
           [&](Deviations& off) { off.part[i] = errors.resistor_percent / 100.0; });
    }
  }

  void sort() {
    const auto size = [](const BudgetLine& one) {
      return *std::max_element(one.percent.begin(), one.percent.end());
    };
    std::stable_sort(lines.begin(), lines.end(),
                     [&](const BudgetLine& a, const BudgetLine& b) { return size(a) > size(b); });
  }

  std::vector<BudgetLine> lines;

 private:
  const Layout& layout_;
  Curve curve_;
  std::vector<std::vector<double>> good_;
};

std::vector<double> root_of_squares(const std::vector<BudgetLine>& lines, size_t branches) {
  std::vector<double> out(branches, 0.0);
  for (const BudgetLine& one : lines) {
    for (size_t b = 0; b < branches; ++b) out[b] += one.percent[b] * one.percent[b];
  }
  for (double& value : out) value = std::sqrt(value);
  return out;
}

void amplitude_budget(const Layout& layout, Budget& out) {
  const AmplitudeControl& amplitude = *layout.amplitude;
  std::vector<double> x;
  for (int i = 0; i <= 20; ++i) x.push_back(i / 20.0);
  const GeneratorAtRest generator(layout, true);
  Budgeting all(layout, [&](const Deviations& off, size_t b) {
    std::vector<double> d;
    for (const double alpha : amplitude.alpha) {
      const std::vector<double> one = generator.curve(b, x, alpha, off);
      d.insert(d.end(), one.begin(), one.end());
    }
    return d;
  });
  for (size_t b = 0; b < amplitude.multipliers.size(); ++b) {
    all.multiplier(layout.product(amplitude.multipliers[b]).name,
                   static_cast<std::size_t>(amplitude.multipliers[b]), out.errors);
    all.line("control op-amp of " + layout.branches[b].name + ", offset",
             offset_of(amplitude.controls[b].opamp, out.errors));
  }
  all.resistors(true, out.errors);
  all.sort();
  out.amplitude_lines = std::move(all.lines);
  out.amplitude_rss_percent = root_of_squares(out.amplitude_lines, layout.branches.size());
  for (size_t b = 0; b < layout.branches.size(); ++b)
    out.amplitude_rss_percent[b] = std::hypot(out.amplitude_rss_percent[b], out.rss_percent[b]);
}

}  // namespace

using schematic::Deviations;

GeneratorAtRest::GeneratorAtRest(const Layout& layout, bool with_amplitude)
    : layout_(layout),
      with_amplitude_(with_amplitude),
      order_(layout.generator(with_amplitude),
             with_amplitude ? std::vector<std::string>{"x", "amplitude"} : std::vector<std::string>{"x"}) {}

std::vector<double> GeneratorAtRest::curve(std::size_t branch, const std::vector<double>& x, double alpha,
                                           const Deviations& off) const {
  schematic::RestPoint rest(order_, off.of_part(order_.netlist(), layout_));
  if (with_amplitude_) rest.set(order_.node("amplitude"), alpha);
  const int in = order_.node("x"), out = order_.node("out");
  std::vector<double> d;
  for (const double at : x) {
    rest.set(in, at);
    rest.settle(static_cast<int>(branch));
    d.push_back(rest.volts(out));
  }
  return d;
}

std::vector<double> GeneratorAtRest::curve(std::size_t branch, const std::vector<double>& x,
                                           double alpha) const {
  return curve(branch, x, alpha, Deviations::none(layout_));
}

double GeneratorAtRest::control_v(std::size_t branch, double alpha) const {
  schematic::RestPoint rest(order_, Deviations::none(order_.netlist()));
  rest.set(order_.node("amplitude"), alpha);
  rest.settle(0);
  return rest.volts(layout_.op(layout_.amplitude->controls[branch].opamp).out);
}

Deviations multipliers_at_limit(const Layout& layout, const ErrorLimits& errors) {
  Deviations out = Deviations::none(layout);
  for (MultiplierDeviation& one : out.multiplier) one = errors.multiplier_at_limit();
  return out;
}

Budget make_budget(const Layout& layout, const ErrorLimits& errors) {
  Budget out;
  out.errors = errors;
  const size_t branches = layout.branches.size();
  const std::vector<double> x = points();
  const GeneratorAtRest generator(layout);
  Budgeting all(layout, [&](const Deviations& off, size_t b) { return generator.curve(b, x, 1.0, off); });
  for (size_t i = 0; i < layout.generator_multipliers(); ++i)
    all.multiplier(layout.multipliers[i].name, i, errors);
  for (size_t s = 0; s < layout.sums.size(); ++s) {
    all.line("op-amp " + layout.op(layout.sums[s].opamp).name + " of " +
                 layout.op(layout.sums[s].opamp).role + ", offset",
             offset_of(layout.sums[s].opamp, errors));
  }
  all.line("output op-amp, offset", offset_of(layout.output_opamp, errors));
  if (layout.switched()) {
    all.line("switch, on-resistance",
             [&](Deviations& off) { off.switch_relative = errors.switch_ohm_percent / 100.0; });
  }
  all.resistors(false, errors);
  all.sort();
  out.lines = std::move(all.lines);
  out.rss_percent = root_of_squares(out.lines, branches);
  out.worst_percent.assign(branches, 0.0);
  for (const BudgetLine& one : out.lines) {
    for (size_t b = 0; b < branches; ++b) out.worst_percent[b] += one.percent[b];
  }
  if (layout.amplitude) amplitude_budget(layout, out);
  return out;
}

void add_nodes(Layout& layout) {
  // + 0.0: no "-0.0" in the files.
  const auto add = [&](std::string name, std::string what, double low, double high) {
    layout.nodes.push_back({std::move(name), std::move(what), low + 0.0, high + 0.0});
  };
  add("x", "reference, 1 V is full stroke", 0.0, 1.0);
  std::vector<bool> in_branch(layout.generator_multipliers(), false);
  for (const Branch& b : layout.branches) {
    for (const int index : b.multipliers) in_branch[static_cast<std::size_t>(index)] = true;
  }
  for (std::size_t i = 0; i < layout.generator_multipliers(); ++i) {
    const Multiplier& m = layout.multipliers[i];
    if (!in_branch[i]) add(m.out, m.role, 0.0, m.peak_v);
  }
  double low_out = 0.0, high_out = 0.0;
  for (const Branch& b : layout.branches) {
    for (const int index : b.sums) {
      const Sum& s = layout.sums[static_cast<std::size_t>(index)];
      if (const std::string& made = layout.op(s.opamp).out; made != b.out)
        add(made, fmt::format("sum of a group, {}", b.name), -s.peak_v, s.peak_v);
    }
    for (const int index : b.multipliers) {
      const Multiplier& m = layout.multipliers[static_cast<std::size_t>(index)];
      if (m.out != b.out) add(m.out, m.role, -m.peak_v, m.peak_v);
    }
    double low = 0.0, high = 0.0;
    for (int i = 0; i <= kPolynomialPoints; ++i) {
      const double d = b.value(static_cast<double>(i) / kPolynomialPoints);
      low = std::min(low, d);
      high = std::max(high, d);
    }
    add(b.out, fmt::format("-{} d(x), {}", rounded_text(layout.branch_gain), b.name),
        -layout.branch_gain * high, -layout.branch_gain * low);
    low_out = std::min(low_out, low);
    high_out = std::max(high_out, high);
  }
  if (layout.switched()) {
    add("sw", "behind the branch switch", -layout.branch_gain * high_out, -layout.branch_gain * low_out);
  }
  if (layout.amplitude) {
    for (std::size_t b = 0; b < layout.branches.size(); ++b) {
      const Sum& control = layout.amplitude->controls[b];
      add(layout.op(control.opamp).out, "control voltage, " + layout.branches[b].name, -control.peak_v,
          control.peak_v);
      const Multiplier& m = layout.product(layout.amplitude->multipliers[b]);
      add(m.out, m.role, -m.peak_v, m.peak_v);
    }
  }
  add("out", "d(x), 1 V per unit", low_out, high_out);
}

}  // namespace bodesmith::generator
