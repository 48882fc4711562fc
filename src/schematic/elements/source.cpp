#include "schematic/elements/element.hpp"

namespace bodesmith::schematic {
namespace {

/// V(node) = volts, whatever current it takes.
class SourceElement final : public Element {
 public:
  SourceElement(int node, int branch, double volts) : node_(node), branch_(branch), volts_(volts) {}
  void stamp(const Point& at, Stamps& to) const override {
    to.add(node_, -at[branch_], 0.0);
    to.slope(node_, branch_, -1.0, 0.0);
    to.add(branch_, at[node_] - volts_, 0.0);
    to.slope(branch_, node_, 1.0, 0.0);
  }

 private:
  int node_, branch_;
  double volts_;
};

}  // namespace

std::unique_ptr<Element> make_source(int node, int branch, double volts) {
  return std::make_unique<SourceElement>(node, branch, volts);
}

}  // namespace bodesmith::schematic
