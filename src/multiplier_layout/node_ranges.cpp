#include <fmt/format.h>

#include <algorithm>

#include "base/text.hpp"
#include "multiplier_layout/build.hpp"

namespace bodesmith::multiplier_layout {

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
      const Sum& control = layout.amplitude->controls[b].sum;
      add(layout.op(control.opamp).out, "control voltage, " + layout.branches[b].name, -control.peak_v,
          control.peak_v);
      const Multiplier& m = layout.product(layout.amplitude->multipliers[b]);
      add(m.out, m.role, -m.peak_v, m.peak_v);
    }
  }
  add("out", "d(x), 1 V per unit", low_out, high_out);
}

}  // namespace bodesmith::multiplier_layout
