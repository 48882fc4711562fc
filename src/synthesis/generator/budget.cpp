#include "synthesis/generator/budget.hpp"

#include <algorithm>
#include <cmath>

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

}  // namespace

Budget make_budget(const DisturbanceCircuit& layout, const PartErrors& errors) {
  Budget out;
  out.errors = errors;
  const std::size_t branches = layout.branches.size();
  const std::vector<double> x = points(layout.amplitude ? 20 : 100);
  const RestWiring wiring(layout);
  const AtRest good(wiring, Deviations::none(layout));
  const auto disturbance = [&](const AtRest& copy, std::size_t b) {
    std::vector<double> d;
    for (const double alpha : layout.strokes()) {
      const std::vector<double> one = curve(copy, b, x, alpha);
      d.insert(d.end(), one.begin(), one.end());
    }
    return d;
  };
  std::vector<std::vector<double>> wanted;
  for (std::size_t b = 0; b < branches; ++b) wanted.push_back(disturbance(good, b));
  out.rss_percent.assign(branches, 0.0);
  out.worst_percent.assign(branches, 0.0);
  for (const Cause& cause : causes_of(layout, errors)) {
    const double deviation = cause.departure.deviation();
    const AtRest copy(wiring, copy_of(layout, {cause}, {deviation}).off, &good);
    BudgetLine line{cause.name, {}};
    for (std::size_t b = 0; b < branches; ++b) {
      const double percent = 100.0 * greatest_difference(disturbance(copy, b), wanted[b]);
      line.percent.push_back(percent);
      out.rss_percent[b] = std::hypot(out.rss_percent[b], percent);
      out.worst_percent[b] += percent * cause.departure.limit() / deviation;
    }
    if (std::ranges::max(line.percent) > 0.0) out.lines.push_back(std::move(line));
  }
  std::ranges::stable_sort(out.lines, std::ranges::greater(),
                           [](const BudgetLine& one) { return std::ranges::max(one.percent); });
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
