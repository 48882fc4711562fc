#include "schematic/elements/element.hpp"

namespace bodesmith::schematic {
namespace {

/// i = v/R; thermal noise 4 k T/R in parallel with it.
class Resistor final : public Element {
 public:
  Resistor(int from, int to, double ohm) : from_(from), to_(to), siemens_(1.0 / ohm) {}
  void stamp(const Point& at, Stamps& to) const override {
    to.between(from_, to_, siemens_ * (at[from_] - at[to_]), 0.0, siemens_, 0.0);
  }
  void noise(RadPerSecond, bool, NoiseSources& to) const override {
    to.add(from_, to_, 4.0 * kBoltzmann * kKelvin * siemens_);
  }
  std::optional<double> power_of_value() const override { return -1.0; }

 private:
  int from_, to_;
  double siemens_;
};

}  // namespace

std::unique_ptr<Element> make_resistor(int from, int to, double ohm) {
  return std::make_unique<Resistor>(from, to, ohm);
}

}  // namespace bodesmith::schematic
