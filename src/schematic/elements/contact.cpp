#include <algorithm>

#include "schematic/elements/element.hpp"

namespace bodesmith::schematic {
namespace {

/// A contact that stays as it is: its resistance closed, its leakage open, a capacitance to ground at each end.
class ContactElement final : public Element {
 public:
  ContactElement(int from, int to, const SwitchModel& model, bool closed)
      : from_(from), to_(to), siemens_(closed ? 1.0 / std::max(model.on_ohm, kLeastOhm) : model.off_siemens) {
    source_f_ = model.source_f;
    drain_f_ = std::max(model.drain_f, model.gate_f());  // the gate's own is part of the data sheet's
  }

  void stamp(const Point& at, Stamps& to) const override {
    to.between(from_, to_, siemens_ * (at[from_] - at[to_]), 0.0, siemens_, 0.0);
    to.between(from_, kGround, 0.0, source_f_ * at[from_], 0.0, source_f_);
    to.between(to_, kGround, 0.0, drain_f_ * at[to_], 0.0, drain_f_);
  }
  void noise(RadPerSecond, const Point&, bool, NoiseSources& to) const override {
    to.add(from_, to_, 4.0 * kBoltzmann * kKelvin * siemens_);
  }

 private:
  static constexpr double kLeastOhm = 1e-3;
  int from_, to_;
  double siemens_, source_f_ = 0.0, drain_f_ = 0.0;
};

}  // namespace

std::unique_ptr<Element> make_contact(int from, int to, const SwitchModel& model, bool closed) {
  return std::make_unique<ContactElement>(from, to, model, closed);
}

}  // namespace bodesmith::schematic
