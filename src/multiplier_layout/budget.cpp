#include "multiplier_layout/budget.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "multiplier_layout/at_rest.hpp"

namespace bodesmith::multiplier_layout {
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
             offset_of(amplitude.controls[b].sum.opamp, out.errors));
  }
  all.resistors(true, out.errors);
  all.sort();
  out.amplitude_lines = std::move(all.lines);
  out.amplitude_rss_percent = root_of_squares(out.amplitude_lines, layout.branches.size());
  for (size_t b = 0; b < layout.branches.size(); ++b)
    out.amplitude_rss_percent[b] = std::hypot(out.amplitude_rss_percent[b], out.rss_percent[b]);
}

}  // namespace

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

}  // namespace bodesmith::multiplier_layout
