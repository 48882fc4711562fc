#pragma once

#include <vector>

#include "multiplier_layout/layout.hpp"
#include "schematic/analysis/rest_point.hpp"

namespace bodesmith::multiplier_layout {

/// The generator at rest: d(x) of a layout's own netlist. Deviations are by place in the layout's lists.
class GeneratorAtRest {
 public:
  explicit GeneratorAtRest(const Layout& layout, bool with_amplitude = false);

  /// d at each x, of the stroke alpha where the amplitude gains are in.
  std::vector<double> curve(std::size_t branch, const std::vector<double>& x, double alpha,
                            const schematic::Deviations& off) const;
  std::vector<double> curve(std::size_t branch, const std::vector<double>& x, double alpha = 1.0) const;
  /// Control voltage of a branch's amplitude gain, V.
  double control_v(std::size_t branch, double alpha) const;

 private:
  const Layout& layout_;
  bool with_amplitude_;
  schematic::RestOrder order_;
};

}  // namespace bodesmith::multiplier_layout
