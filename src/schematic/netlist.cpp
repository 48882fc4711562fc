#include "schematic/netlist.hpp"

#include <cmath>

#include "base/error.hpp"

namespace bodesmith::schematic {

Netlist::Netlist() = default;
Netlist::Netlist(const Netlist&) = default;
Netlist::Netlist(Netlist&&) noexcept = default;
Netlist& Netlist::operator=(const Netlist&) = default;
Netlist& Netlist::operator=(Netlist&&) noexcept = default;
Netlist::~Netlist() = default;

Complex OpAmpModel::open_loop(RadPerSecond w) const {
  return dc_gain / Complex(1.0, w.value * dc_gain / gain_bandwidth.rad_s().value);
}

OpAmpModel OpAmpModel::ideal() {
  OpAmpModel out;
  out.name = "ideal";
  out.is_ideal = true;
  out.gain_bandwidth = Hertz{1e15};
  out.dc_gain = 1e12;
  out.slew_v_per_s = 1e18;
  out.swing_v = 1e6;
  out.output_resistance_ohm = out.bias_current_a = out.offset_v = 0.0;
  out.voltage_noise_v_per_rthz = out.current_noise_a_per_rthz = 0.0;
  out.greatest_output_current_a = 1e6;
  return out;
}

OpAmpModel OpAmpModel::one_pole(Hertz gain_bandwidth, double dc_gain) {
  OpAmpModel out = ideal();
  out.name = "of one pole";
  out.is_ideal = false;
  out.gain_bandwidth = gain_bandwidth;
  out.dc_gain = dc_gain;
  out.slew_v_per_s = out.swing_v = INFINITY;
  return out;
}

SwitchModel SwitchModel::plain(double on_ohm, double off_siemens) {
  SwitchModel out;
  out.name = "plain";
  out.on_ohm = on_ohm;
  out.off_siemens = off_siemens;
  out.on_delay_s = out.gap_s = out.charge_c = out.source_f = out.drain_f = 0.0;
  return out;
}

SwitchModel SwitchModel::for_branches(std::size_t count) {
  SwitchModel out;
  if (count <= 2) return out;
  out.name = "ADG408";
  out.on_ohm = 40.0;
  out.on_delay_s = 120e-9;
  out.gap_s = 10e-9;
  out.charge_c = 20e-12;
  out.source_f = 11e-12;
  out.drain_f = 5e-12;
  return out;
}

SwitchTimer SwitchTimer::of(const SwitchModel& model) {
  if (!(model.gap_s >= 0.0) || !(model.gap_s < model.on_delay_s)) {
    throw DesignError("the switch's break-before-make gap must be at least 0 and shorter than its delay");
  }
  // exp(-on/tau) + exp(-off/tau) rises with tau from 0 to 2; here in units of the delay.
  const double off = model.off_delay_s() / model.on_delay_s;
  double low = 1e-3, high = 10.0;
  for (int i = 0; i < 100; ++i) {
    const double tau = 0.5 * (low + high);
    (std::exp(-1.0 / tau) + std::exp(-off / tau) < 1.0 ? low : high) = tau;
  }
  return {0.5 * (low + high) * model.on_delay_s, std::exp(-off / (0.5 * (low + high)))};
}

const Part* Netlist::part_named(const std::string& name) const {
  const auto at = std::ranges::find(parts, name, &Part::name);
  return at == parts.end() ? nullptr : &*at;
}

namespace {

template <class Element, class Value>
void take(const std::vector<Element>& elements, const std::vector<Element>& whole,
          const std::vector<Value>& from, std::vector<Value>& to) {
  // Mostly in the same order.
  std::size_t k = 0;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    for (std::size_t tries = 0; tries < whole.size(); ++tries, k = (k + 1) % whole.size()) {
      if (whole[k].name != elements[i].name) continue;
      to[i] = from[k];
      break;
    }
  }
}

}  // namespace

Deviations Deviations::of_part(const Netlist& part_of_it, const Netlist& whole) const {
  Deviations out = *this;
  const Deviations nothing = none(part_of_it);
  out.part = nothing.part;
  out.opamp_offset_v = nothing.opamp_offset_v;
  out.multiplier = nothing.multiplier;
  out.source = nothing.source;
  take(part_of_it.parts, whole.parts, part, out.part);
  take(part_of_it.opamps, whole.opamps, opamp_offset_v, out.opamp_offset_v);
  take(part_of_it.multipliers, whole.multipliers, multiplier, out.multiplier);
  take(part_of_it.sources, whole.sources, source, out.source);
  return out;
}

}  // namespace bodesmith::schematic
