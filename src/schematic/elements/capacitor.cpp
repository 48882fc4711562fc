#include "schematic/elements/element.hpp"

namespace bodesmith::schematic {
namespace {

/// q = C v.
class Capacitor final : public Element {
 public:
  Capacitor(int from, int to, double farad) : from_(from), to_(to), farad_(farad) {}
  void stamp(const Point& at, Stamps& to) const override {
    to.between(from_, to_, 0.0, farad_ * (at[from_] - at[to_]), 0.0, farad_);
  }
  std::optional<double> power_of_value() const override { return 1.0; }

 private:
  int from_, to_;
  double farad_;
};

}  // namespace

std::unique_ptr<Element> make_capacitor(int from, int to, double farad) {
  return std::make_unique<Capacitor>(from, to, farad);
}

}  // namespace bodesmith::schematic
