#include <algorithm>

#include "schematic/elements/element.hpp"

namespace bodesmith::schematic {
namespace {

/// A contact that stays as it is: its resistance closed, its leakage open, a capacitance to ground at each end.
class ContactElement final : public Element {
 public:
  ContactElement(int from, int to, const SwitchModel& model, bool closed)
      : from_(from), to_(to), siemens_(closed ? model.on_siemens() : model.off_siemens) {
    source_f_ = model.source_f;
    drain_f_ = std::max(model.drain_f, model.gate_f());  // the gate's own is part of the data sheet's
  }

  void stamp(const Point& at, Stamps& to) const override {
    to.between(from_, to_, siemens_ * (at[from_] - at[to_]), 0.0, siemens_, 0.0);
    to.between(from_, kGround, 0.0, source_f_ * at[from_], 0.0, source_f_);
    to.between(to_, kGround, 0.0, drain_f_ * at[to_], 0.0, drain_f_);
  }
  void noise(RadPerSecond, bool, NoiseSources& to) const override {
    to.add(from_, to_, 4.0 * kBoltzmann * kKelvin * siemens_);
  }

 private:
  int from_, to_;
  double siemens_, source_f_ = 0.0, drain_f_ = 0.0;
};

/// The contact of templates/spice/switch.sub: a timer, tau dt/dt = control - t, closes it over 1/kSharpness of its level; one
/// step of the gate earlier the gate's charge goes through its capacitance onto `to`.
class MovingContact final : public Element {
 public:
  MovingContact(int from, int to, const Control& by, const SwitchModel& model)
      : from_(from), to_(to), by_(by), model_(model), timer_(SwitchTimer::of(model)) {}

  void stamp(const Point& at, Stamps& to) const override {
    to.add(by_.timer, at[by_.timer] - at[by_.node], timer_.tau_s * at[by_.timer]);
    to.slope(by_.timer, by_.timer, 1.0, timer_.tau_s);
    to.slope(by_.timer, by_.node, -1.0, 0.0);
    const double beyond = kSharpness * (at[by_.timer] - timer_.level), v = at[from_] - at[to_];
    const double closed = std::clamp(beyond, 0.0, 1.0),
                 moves = beyond > 0.0 && beyond < 1.0 ? kSharpness : 0.0;
    const double siemens = model_.off_siemens + closed * model_.on_siemens();
    to.between(from_, to_, siemens * v, 0.0, siemens, 0.0);
    to.slope(from_, by_.timer, v * moves * model_.on_siemens(), 0.0);
    to.slope(to_, by_.timer, -v * moves * model_.on_siemens(), 0.0);
    to.between(from_, kGround, 0.0, model_.source_f * at[from_], 0.0, model_.source_f);
    const double gate = SwitchModel::kGateSwing * std::clamp(beyond + 1.0, 0.0, 1.0),
                 swings = beyond > -1.0 && beyond < 0.0 ? SwitchModel::kGateSwing * kSharpness : 0.0;
    const double rest = std::max(model_.drain_f - model_.gate_f(), 0.0), all = rest + model_.gate_f();
    to.add(to_, 0.0, all * at[to_] - model_.gate_f() * gate);
    to.slope(to_, to_, 0.0, all);
    to.slope(to_, by_.timer, 0.0, -model_.gate_f() * swings);
  }

 private:
  static constexpr double kSharpness = 400.0;
  int from_, to_;
  Control by_;
  SwitchModel model_;
  SwitchTimer timer_;
};

}  // namespace

std::unique_ptr<Element> make_moving_contact(int from, int to, const Control& by, const SwitchModel& model) {
  return std::make_unique<MovingContact>(from, to, by, model);
}

std::unique_ptr<Element> make_contact(int from, int to, const SwitchModel& model, bool closed) {
  return std::make_unique<ContactElement>(from, to, model, closed);
}

}  // namespace bodesmith::schematic
