#include "multiplier_layout/at_rest.hpp"

namespace bodesmith::multiplier_layout {

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
  return rest.volts(layout_.op(layout_.amplitude->controls[branch].sum.opamp).out);
}

}  // namespace bodesmith::multiplier_layout
