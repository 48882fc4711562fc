#include "fpaa/network/switched_netlist.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/whole_number.hpp"
#include "fpaa/device/mismatch.hpp"
#include "schematic/writers/spice_library.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr int kLargestClockRatio = 1000;  ///< whole numbers of the clocks' ratios

/// Frequencies of the phases' clocks, and the least number of ticks a second of which all half periods are whole numbers.
void find_clocks(SwitchedNetlist& out, const std::string& file) {
  for (const schematic::ClockPhase& one : out.circuit.netlist.clock_phases) {
    const auto known =
        std::ranges::find_if(out.clocks, [&](Hertz f) { return f.value == one.frequency.value; });
    out.circuit.phases.push_back({one.node, static_cast<int>(known - out.clocks.begin()), one.phase});
    if (known == out.clocks.end()) out.clocks.push_back(one.frequency);
  }
  if (out.clocks.empty())
    throw InputError(file + ": there is no clock, expected a line .clock NAME FREQUENCY");
  double fastest = 0.0;
  for (const Hertz f : out.clocks) fastest = std::max(fastest, f.value);
  for (int scale = 1; scale <= kLargestClockRatio; ++scale) {
    out.ticks.clear();
    for (const Hertz f : out.clocks) {
      const double periods = scale * fastest / f.value;
      if (periods > 1e12 || std::abs(periods - std::round(periods)) > 1e-9 * periods) break;
      out.ticks.push_back(2 * nearest_whole<std::int64_t>(periods));
    }
    out.ticks_per_second = 2.0 * scale * fastest;
    if (out.ticks.size() == out.clocks.size()) return;
  }
  throw InputError(file +
                   ": the clocks' frequencies stand in no ratio of whole numbers up to 1000, expected one");
}

}  // namespace

SwitchedNetlist SwitchedNetlist::read(std::string_view text, const std::string& file) {
  const schematic::SpiceLibrary library = schematic::read_spice(std::string(text), file);
  const schematic::Subcircuit& top = library.subcircuit(library.top);
  if (top.pins.size() != 2)
    throw InputError(fmt::format("{}: {} has {} pins, expected its input and its output", file, top.name,
                                 top.pins.size()));
  SwitchedNetlist out;
  out.circuit.netlist = library.flat(top.name);
  out.circuit.inputs = {top.pins[0]};
  find_clocks(out, file);
  // An op-amp's output, or a follower of another node.
  schematic::Netlist& netlist = out.circuit.netlist;
  out.circuit.output = top.pins[1];
  if (std::ranges::find(netlist.opamps, top.pins[1], &schematic::OpAmp::out) == netlist.opamps.end()) {
    netlist.other_opamps.push_back(schematic::OpAmpModel::ideal());
    out.circuit.output = "follower of " + top.pins[1];
    netlist.opamps.push_back(
        {"", "", 0, top.pins[1], out.circuit.output, out.circuit.output, netlist.other_opamps.size()});
  }
  out.unit_f = 0.0;
  for (const schematic::Part& c : netlist.parts) out.unit_f = std::max(out.unit_f, c.realised);
  if (!(out.unit_f > 0.0)) throw InputError(file + ": there are no capacitors, expected at least one");
  for (schematic::Part& c : netlist.parts) c.realised /= out.unit_f;
  if (netlist.analog_switch.is_plain()) out.circuit.switch_s = netlist.analog_switch.on_ohm * out.unit_f;
  return out;
}

PeriodicNetworks SwitchedNetlist::networks(std::optional<double> temperature_k) const {
  using Source = PeriodicNetworks::Source;
  SwitchedCircuit noisy = circuit;
  // In square roots of kT over the unit of capacitance.
  const double unit = temperature_k ? std::sqrt(thermal_v2(*temperature_k)) : 1.0;
  noisy.netlist.opamp.voltage_noise_v_per_rthz /= unit;
  for (schematic::OpAmpModel& model : noisy.netlist.other_opamps) model.voltage_noise_v_per_rthz /= unit;
  PeriodicNetworks out(ticks_per_second);
  out.set_output(out.add(ClockedNetwork(noisy, ticks, temperature_k.has_value()),
                         {Source{Source::Kind::board_input, 0}}));
  return out;
}

double SwitchedNetlist::thermal_v2(double temperature_k) const {
  return std::pow(NoiseModel{.unit_capacitance_f = unit_f, .temperature_k = temperature_k}.unit_noise_v(), 2);
}

}  // namespace bodesmith::fpaa
