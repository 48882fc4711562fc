#include "synthesis/generator/budget.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/text.hpp"
#include "synthesis/generator/at_rest.hpp"
#include "synthesis/generator/build.hpp"

namespace bodesmith::generator {
namespace {

std::vector<double> points(int intervals) {
  std::vector<double> out;
  for (int i = 0; i <= intervals; ++i) out.push_back(static_cast<double>(i) / intervals);
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

/// Spoils one thing after the other and notes how far d moves.
class Budgeting {
 public:
  Budgeting(const DisturbanceCircuit& layout, Curve curve) : layout_(layout), curve_(std::move(curve)) {
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

  void resistors(const ErrorLimits& errors) {
    for (size_t i = 0; i < layout_.parts.size(); ++i) {
      const Part& part = layout_.parts[i];
      if (part.kind != Part::Kind::resistor ||
          layout_.purpose_of(part.group) == schematic::Purpose::slope_sign)
        continue;
      line(part.name + ", tolerance",
           [&](Deviations& off) { off.part[i] = errors.resistor_percent / 100.0; });
    }
  }

  void sort() {
    const auto size = [](const BudgetLine& one) { return *std::ranges::max_element(one.percent); };
    std::ranges::stable_sort(lines,
                             [&](const BudgetLine& a, const BudgetLine& b) { return size(a) > size(b); });
  }

  std::vector<BudgetLine> lines;

 private:
  const DisturbanceCircuit& layout_;
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

}  // namespace

Deviations multipliers_at_limit(const DisturbanceCircuit& layout, const ErrorLimits& errors) {
  Deviations out = Deviations::none(layout);
  for (MultiplierDeviation& one : out.multiplier) one = errors.multiplier_at_limit();
  return out;
}

Budget make_budget(const DisturbanceCircuit& layout, const ErrorLimits& errors) {
  Budget out;
  out.errors = errors;
  const size_t branches = layout.branches.size();
  const std::vector<double> x = points(layout.amplitude ? 20 : 100);
  const RestWiring wiring(layout);
  const AtRest good(wiring, Deviations::none(layout));
  Budgeting all(layout, [&](const Deviations& off, size_t b) {
    std::vector<double> d;
    const AtRest copy(wiring, off, &good);
    for (const double alpha : layout.strokes()) {
      const std::vector<double> one = curve(copy, b, x, alpha);
      d.insert(d.end(), one.begin(), one.end());
    }
    return d;
  });
  for (size_t i = 0; i < layout.multipliers.size(); ++i)
    all.multiplier(layout.multipliers[i].name, i, errors);
  for (size_t i = 0; i < layout.opamps.size(); ++i) {
    const schematic::OpAmp& one = layout.opamps[i];
    if (one.type != 0) continue;
    all.line(fmt::format("{} ({}), offset", one.name, one.role),
             [&](Deviations& off) { off.opamp_offset_v[i] = errors.opamp_offset_v; });
  }
  if (layout.switched()) {
    all.line("switch, on-resistance",
             [&](Deviations& off) { off.switch_relative = errors.switch_ohm_percent / 100.0; });
  }
  all.resistors(errors);
  all.sort();
  out.lines = std::move(all.lines);
  out.rss_percent = root_of_squares(out.lines, branches);
  out.worst_percent.assign(branches, 0.0);
  for (const BudgetLine& one : out.lines) {
    for (size_t b = 0; b < branches; ++b) out.worst_percent[b] += one.percent[b];
  }
  return out;
}

void add_nodes(DisturbanceCircuit& layout) {
  std::vector<NodeRange> nodes = {{"x", "reference, 1 V is full stroke"}};
  for (const Multiplier& one : layout.multipliers) nodes.push_back({one.out, one.role});
  for (const schematic::OpAmp& one : layout.opamps) {
    // A rectifier's op-amp stands a diode's voltage beyond what it makes.
    const bool rectifies = std::ranges::any_of(layout.parts, [&](const Part& part) {
      return part.kind == Part::Kind::diode && (part.from == one.out || part.to == one.out);
    });
    if (one.type == 0 && !rectifies && one.out != "out") nodes.push_back({one.out, one.role});
  }
  if (layout.switched()) nodes.push_back({"sw", "behind the branch switch"});
  nodes.push_back({"out", "d(x), 1 V per unit"});
  const RestWiring wiring(layout);
  AtRest at(wiring, Deviations::none(layout));
  for (std::size_t b = 0; b < layout.branches.size(); ++b) {
    for (const double alpha : layout.strokes()) {
      at.set_stroke(alpha);
      for (const double x : points(100)) {
        at.made(0.0, x, b);
        for (NodeRange& one : nodes) {
          const double volts = at.volts(one.name) + 0.0;  // no "-0.0" in the files
          one.lowest_v = std::min(one.lowest_v, volts);
          one.highest_v = std::max(one.highest_v, volts);
        }
      }
    }
  }
  layout.nodes = std::move(nodes);
}

}  // namespace bodesmith::generator
