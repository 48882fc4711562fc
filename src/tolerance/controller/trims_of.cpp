#include <fmt/format.h>

#include "base/text.hpp"
#include "tolerance/controller/trim.hpp"

namespace bodesmith::tolerance {
namespace {

using generator::DisturbanceCircuit;

/// Of the offset potentiometers, either side, V.
constexpr double kOffsetRange = 30e-3;
constexpr double kSteps = 1000.0;

std::string ohm(double value) {
  return engineering_text(value, "ohm", 3);
}

/// A potentiometer across the supplies or a reference, divided down to a pin.
std::string divided_down(double range) {
  return fmt::format(
      "10 kohm between +2.5 V and -2.5 V, its wiper through {} to the pin and {} from there to ground",
      ohm(2.5 / range * 100.0), ohm(100.0));
}

void add_multiplier_trims(const DisturbanceCircuit& c, int index, std::vector<Trim>& out) {
  const auto i = static_cast<std::size_t>(index);
  const schematic::Multiplier& m = c.multipliers[i];
  if (m.z == "0") {
    out.push_back({"offset of " + m.name,
                   fmt::format("pin Z of {} ({}): {}", m.name, m.role, divided_down(kOffsetRange)), "V",
                   2.0 * kOffsetRange / kSteps, kOffsetRange,
                   [i](generator::Copy& copy, double value) { copy.off.multiplier[i].w += value; }});
  }
  out.push_back(
      {"gain of " + m.name,
       fmt::format("scale of {} ({}): 1 kohm as the data sheet's scale adjustment, +-5 %", m.name, m.role),
       "", 0.1 / kSteps, 0.05,
       [i](generator::Copy& copy, double value) { copy.off.multiplier[i].scale += value; }});
  out.push_back({"input of " + m.name,
                 fmt::format("pin X2 of {} ({}): {}", m.name, m.role, divided_down(kOffsetRange)), "V",
                 2.0 * kOffsetRange / kSteps, kOffsetRange,
                 [i](generator::Copy& copy, double value) { copy.off.multiplier[i].x += value; }});
}

void add_part_trim(const DisturbanceCircuit& c, int part, const std::string& name, double range,
                   std::vector<Trim>& out) {
  if (part < 0) return;
  const auto i = static_cast<std::size_t>(part);
  const schematic::Part& one = c.part(part);
  out.push_back({name,
                 fmt::format("{} ({}, {}): {} less, with a potentiometer of {} in series", one.name, one.role,
                             ohm(one.realised), ohm(range * one.realised), ohm(2.0 * range * one.realised)),
                 "", 2.0 * range / kSteps, range,
                 [i](generator::Copy& copy, double value) { copy.off.part[i] += value; }});
}

}  // namespace

std::vector<Trim> trims_of(const DisturbanceCircuit& controller) {
  const DisturbanceCircuit& c = controller;
  std::vector<Trim> out;
  const generator::Pass::Output& output = c.passes.back().output;
  const auto opamp = static_cast<std::size_t>(output.opamp);
  const double feedback = c.part(output.feedback).realised;
  const double minus = 1.0 / (c.part(output.disturbance).realised + c.analog_switch.on_ohm);
  const double noise_gain = 1.0 + feedback * minus;
  out.push_back(
      {"output offset",
       fmt::format("{} (subtraction): 10 kohm between +2.5 V and -2.5 V, its wiper through {} to node {}",
                   c.op(output.opamp).name, ohm(feedback * 2.5 / kOffsetRange), c.op(output.opamp).minus),
       "V", 2.0 * kOffsetRange / kSteps, kOffsetRange,
       [opamp, noise_gain](generator::Copy& copy, double value) {
         copy.off.opamp_offset_v[opamp] += value / noise_gain;
       }});
  add_part_trim(c, output.feedback, "generator gain", 0.05, out);
  add_part_trim(c, output.reference, "reference gain", 0.01, out);
  for (const generator::Pass& pass : c.passes) {
    for (const int power : pass.multipliers) add_multiplier_trims(c, power, out);
  }
  if (c.slope) add_part_trim(c, c.slope->gain, "rate gain", 0.05, out);
  return out;
}

std::string Reading::words(const DisturbanceCircuit& controller, Hertz fastest) const {
  const std::string at = rounded_text(r, 3);
  switch (kind) {
    case Kind::rising:
      return fmt::format("v at r = {} V, coming slowly from below", at);
    case Kind::falling:
      return fmt::format("v at r = {} V, coming slowly from above", at);
    case Kind::mean:
      return fmt::format("v at r = {} V, the mean of coming slowly from below and from above", at);
    case Kind::difference:
      return fmt::format("v at r = {} V coming slowly from below, less that from above", at);
    case Kind::slope: {
      const std::string node = controller.slope ? controller.op(controller.slope->full_wave_opamp).out : "";
      return fmt::format("the mean of -v({}) while r is a triangle from 0 to {} V at {} Hz", node,
                         rounded_text(controller.reference_stroke, 3), rounded_text(fastest.value));
    }
  }
  return {};
}

double read(const Reading& reading, const Board& board, const Input& fastest) {
  const double r = reading.r;
  switch (reading.kind) {
    case Reading::Kind::rising:
      return board.at_rest(r, true);
    case Reading::Kind::falling:
      return board.at_rest(r, false);
    case Reading::Kind::mean:
      return 0.5 * (board.at_rest(r, true) + board.at_rest(r, false));
    case Reading::Kind::difference:
      return board.at_rest(r, true) - board.at_rest(r, false);
    case Reading::Kind::slope:
      return board.mean_slope_v(fastest);
  }
  return 0.0;
}

}  // namespace bodesmith::tolerance
