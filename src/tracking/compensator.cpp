#include "tracking/compensator.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "signal/disturbance.hpp"

namespace bodesmith::tracking {
namespace {

using Complex = std::complex<double>;

/// Sum of coefficients times powers of z^-1.
Complex z_polynomial(const std::vector<double>& coefficients, Complex z1) {
  Complex sum = 0.0;
  for (std::size_t i = coefficients.size(); i-- > 0;) sum = sum * z1 + coefficients[i];
  return sum;
}

Complex clocked_response(const ClockedCompensator& c, RadPerSecond w) {
  // Beyond half the clock the unit circle repeats; without hold the capacitors' own answer is held at its
  // last value.
  const double cycles = w.hz().value / c.clock.value;
  const double used = c.hold_and_delays ? cycles : std::min(cycles, 0.5);
  const Complex z1 = std::polar(1.0, -2.0 * std::numbers::pi * used);
  Complex h = c.gain;
  for (const auto& section : c.sections) {
    h *= z_polynomial(section.numerator, z1) / z_polynomial(section.denominator, z1);
  }
  if (!c.hold_and_delays) return h;
  const double phase = std::numbers::pi * cycles;
  const double sinc = phase == 0.0 ? 1.0 : std::sin(phase) / phase;
  return h * sinc * std::polar(1.0, -phase * (1.0 + 2.0 * c.delay_cycles));
}

}  // namespace

std::complex<double> compensator_response(const Compensator& compensator, RadPerSecond w) {
  struct At {
    RadPerSecond w;
    Complex operator()(const Uncompensated&) const { return 0.0; }
    Complex operator()(const ConstantGain& c) const { return c.gain; }
    Complex operator()(const Sections& c) const { return c.response(w); }
    Complex operator()(const ResponseCompensator& c) const { return c.response(w); }
    Complex operator()(const ClockedCompensator& c) const { return clocked_response(c, w); }
    Complex operator()(const ScheduledGain&) const { return 0.0; }
  };
  return std::visit(At{w}, compensator);
}

Compensator settled_at(const Compensator& compensator, Hertz frequency) {
  const auto* scheduled = std::get_if<ScheduledGain>(&compensator);
  if (scheduled == nullptr) return compensator;
  Disturbance table;
  table.rate = {scheduled->frequency, scheduled->gain, scheduled->gain};
  return ConstantGain{table.rate_gain(Disturbance::Branch::ascending, frequency)};
}

const ClockedCompensator* clocked_part(const Compensator& compensator) {
  const auto* clocked = std::get_if<ClockedCompensator>(&compensator);
  return clocked != nullptr && clocked->hold_and_delays ? clocked : nullptr;
}

}  // namespace bodesmith::tracking
