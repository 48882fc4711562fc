#pragma once

#include <complex>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/json_fwd.hpp"
#include "base/units.hpp"
#include "lti/sections.hpp"
#include "signal/disturbance.hpp"

namespace bodesmith::tracking {

/// How well a disturbance compensator (first seed, Fig. 2) lets a stage follow a triangle or sine, in steady
/// state.
///
///   x(t)   reference, 0 ... alpha of the stroke, at the operating frequency f
///   w_a(t) = d_a(x) while x rises, else 0;  w_d(t) = d_d(x) while x falls, else 0      (the disturbance
///   generator) c(t)   = C_a{w_a} + C_d{w_d}                                                       (the two
///   compensators) v(t)   = D{x - c}                                                                  (drive
///   path: the amplifier, ...) q(t)   = v + k_a(f) w_a or k_d(f) w_d (rate gains of the table at f) y(t)   =
///   stroke P{q}                                                               (damping compensator,
///   resonance) e_rms% = 100 rms(y - stroke x) / (max y - min y)                                   (eq. 8)
///
/// The amplitude gains of the table at alpha multiply both the generator's and the stage's disturbance.

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

/// A compensator known by its frequency response, e.g. the ideal fractional cascade: worked out harmonic by
/// harmonic. `approximation` (high order, with `approximation_error_db`) stands for it in the time domain,
/// when given.
struct ResponseCompensator {
  std::function<std::complex<double>(RadPerSecond)> response;
  std::optional<Sections> approximation;
  double approximation_error_db = 0.0;
};

/// A chain of switched-capacitor sections: sampled at the clock, filtered, held for a cycle.
struct ClockedCompensator {
  /// b0 + b1 z^-1 + ... over a0 + a1 z^-1 + ..., degree at most 2.
  struct SectionZ {
    std::vector<double> numerator;
    std::vector<double> denominator;
  };
  std::vector<SectionZ> sections;
  Hertz clock;
  double gain = 1.0;
  /// Pure delay beyond the hold, in clock cycles (half a cycle for each section that adds one).
  double delay_cycles = 0.0;
  /// False: only the transfer functions on the unit circle, H(e^(jw/fc)), without hold, delay and images:
  /// what the capacitors alone change.
  bool hold_and_delays = true;
};

using Compensator = std::variant<Uncompensated, ConstantGain, Sections, ResponseCompensator,
                                 ClockedCompensator, ScheduledGain>;

/// One row of the comparison.
struct TrackingDesign {
  std::string name;  ///< "constant polynomial", "E96 circuit", ...
  Compensator ascending;
  Compensator descending;
  /// Name of the design it was made from; the report then states how much was lost on the way. Empty: none.
  std::string made_from;
};

struct TrackingPlant {
  Disturbance disturbance;
  double stroke = 1.0;  ///< displacement at x = 1 (the unit is the caller's)
  Sections drive_path;  ///< D: default the identity
  Sections stage_path;  ///< P: default the identity
  /// The generator's polynomials; absent: the plant's own, as if identified without error.
  std::optional<Disturbance> generator;
};

struct TrackingOptions {
  enum class Reference { triangle, sine };
  /// Where the compensators stand. Behind the switch: each filters its own branch's waveform, which is 0
  /// while the other branch is on (w_a, w_d above); the same filter on both branches is one filter behind the
  /// branch switch. Before the switch: each filters its branch's polynomial of x all the time, and the switch
  /// picks one of the two outputs:
  ///   c(t) = C_a{d_a(x)} while x rises, C_d{d_d(x)} while x falls.
  enum class Place { behind_switch, before_switch };
  /// What the stage's own disturbance is a function of: the seed evaluates it on the reference x; a real
  /// stage sees its drive v, and its branch turns with the slope of v.
  enum class Argument { reference, drive };

  std::vector<Hertz> frequencies;
  Reference reference = Reference::triangle;
  Place place = Place::behind_switch;
  Argument argument = Argument::reference;
  double alpha = 1.0;       ///< amplitude of x
  bool time_domain = true;  ///< integrate a period in CVODE (clocked designs: exact propagation) and check
  double relative_tolerance = 1e-7;  ///< CVODE
  int harmonics = 4096;              ///< of the periodic computation; a power of two
  int keep_samples = 400;            ///< samples a period of the waveforms kept in the report
};

struct TrackingCase {
  Hertz frequency;
  std::string design;
  double rms_percent = 0.0;  ///< eq. 8, nothing removed
  double max_percent = 0.0;  ///< largest |y - stroke x| in percent of range
  double lag_s = 0.0;        ///< the pure delay of the reference that makes the rms smallest
  double rms_percent_without_lag = 0.0;
  double check_rms_percent = 0.0;  ///< the same figure by the other method
  double check_difference_percent =
      0.0;                            ///< rms of the difference between both displacements, percent of range
  double waveform_rms_percent = 0.0;  ///< rms of c against the disturbance the stage adds, percent of stroke
  double lost_rms_percent = 0.0;      ///< rms of c against the design it was made from, percent of stroke
  std::string method;                 ///< "cvode", "exact" (clocked) or "harmonic"
  std::string check_method;           ///< empty: not checked
  // One period in steady state, keep_samples of each.
  std::vector<double> time_s;
  std::vector<double> reference;     ///< stroke x
  std::vector<double> displacement;  ///< y
};

struct TrackingReport {
  std::vector<TrackingCase> cases;  ///< designs within frequencies, in the order given
  double compute_s = 0.0;

  const TrackingCase* find(Hertz frequency, const std::string& design) const;
  /// {"cases": [...]}, waveforms only if `with_waveforms`; without a header.
  Json to_json(bool with_waveforms = false) const;
};

TrackingReport track(const TrackingPlant& plant, const std::vector<TrackingDesign>& designs,
                     const TrackingOptions& options);

/// First-order lag as a path: 1/(1 + s/w).
Sections lowpass_path(Hertz corner);
/// Eq. 20 of the first seed, the damping compensator, and its nanopositioner's mode at 65.1 kHz
/// (damping_ratio is not printed; choose it so that the damped stage is flat).
Sections seed_damping_compensator();
Sections resonance_path(Hertz natural_frequency, double damping_ratio);
Sections in_series(const std::vector<Sections>& paths);

}  // namespace bodesmith::tracking
