#pragma once

#include <functional>
#include <optional>
#include <variant>
#include <vector>

#include "base/units.hpp"
#include "lti/sections.hpp"
#include "signal/disturbance.hpp"

namespace bodesmith::tracking {

/// No compensation of this branch at all: c has nothing of it.
struct Uncompensated {};

/// The polynomial at constant gain (the generator alone, no rate compensation).
struct ConstantGain {
  double gain = 1.0;
};

/// A voltage-controlled gain driven by the measured operating frequency: `gain` over `frequency`,
/// interpolated in log frequency and held at the ends, as the disturbance's own rate table. No linear filter,
/// so it turns no phase; in steady state it is a constant gain. It needs a frequency-to-voltage converter
/// that has settled.
struct ScheduledGain {
  std::vector<Hertz> frequency;  ///< rising
  std::vector<double> gain;
};

/// The gain of a branch taken from the slope of the reference as it is measured: a differentiator with a time
/// constant, a rectifier, and where wanted a second time constant that smooths,
///   s = tau-lagged dr/dt,   m = smoothing-lagged |s|,   f = m/(2 alpha),   gain = table(f).
/// It assumes a known amplitude alpha and that the reference goes up and down once a period: a triangle then has
/// |dr/dt| = 2 f alpha all the time, a sine on average (it needs the smoothing); other references are taken for
/// slower or faster than they are.
struct SlopeGain {
  ScheduledGain table;
  double differentiator_s = 1e-4;
  double smoothing_s = 0.0;  ///< 0: none
};

/// A linear filter and a gain set by the known frequency, side by side: c = F{w} + k(f) w. The filter follows what
/// is faster than a period, the schedule adds what the filter lacks at each frequency (rest_of).
struct FilterAndSchedule {
  Sections filter;
  ScheduledGain schedule;
};

/// A compensator known by its frequency response, e.g. the ideal fractional cascade: worked out harmonic by
/// harmonic. `approximation` (of high order) stands for it in the time domain,
/// when given.
struct ResponseCompensator {
  std::function<Complex(RadPerSecond)> response;
  std::optional<Sections> approximation;
};

using Compensator = std::variant<Uncompensated, ConstantGain, Sections, ResponseCompensator, ScheduledGain,
                                 SlopeGain, FilterAndSchedule>;

/// The frequency response by which a compensator acts on a waveform. Gains that are set by a frequency have none (see settled_at) and count as nothing.
Complex compensator_response(const Compensator& compensator, RadPerSecond w);

/// The compensator as it is at one operating frequency: a scheduled gain has become a constant one.
Compensator settled_at(const Compensator& compensator, Hertz frequency);

/// The table at a frequency in Hz, interpolated in log frequency and held at the ends; and its derivative.
double gain_at(const ScheduledGain& table, double hz);
double gain_slope_at(const ScheduledGain& table, double hz);

/// The schedule that adds to `filter` what it lacks of the rate gains `wanted`: at each of its frequencies the gain
/// k that makes the rms of F{w} + k w - K w smallest for the disturbance's waveform w of that branch, alternating
/// as it does when a triangle is followed and the filter stands before the switch.
ScheduledGain rest_of(const Sections& filter, const Disturbance& disturbance, Disturbance::Branch branch);

}  // namespace bodesmith::tracking
