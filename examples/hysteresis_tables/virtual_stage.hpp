#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "numeric/random.hpp"

namespace bench {

/// A piezo stage that belongs to none of the models: the common bench on which their papers' tables are
/// repeated.
///   x = u/u_full
///   memory:     dh/dx = α sgn(ẋ) (f(x) − h) + g(x),  f = x + asymmetry x (1 − x),  g = slope f'(x)
///               (Coleman-Hodgdon / Duhem)
///   rate:       q = h after ((1 + s/ω_b)/(1 + s/ω_a))^β between rate_from and rate_to
///               (fractional lag, 12 sections)
///   creep:      q + Σ creep_gain (1 − e^(−t/τ)) like lags of q
///   amplifier:  first-order lag on the drive
///   resonance:  second order on the motion
///   sensor:     white noise.
/// Every linear part is propagated exactly for an input that is linear between samples.
struct VirtualStageSettings {
  double full_drive = 1.0;   ///< u_full
  double full_stroke = 1.0;  ///< y at x = 1, at rest
  double alpha = 6.0;
  double slope = 0.62;
  double asymmetry = 0.12;
  double rate_from_hz = 1.0;
  double rate_to_hz = 1000.0;
  double rate_beta = 0.02;           ///< above 0: falls with the rate
  bool rate_on_disturbance = false;  ///< the rate acts on h - x only, the straight line stays (000's reading)
  double amplifier_hz = 0.0;         ///< 0: none
  double resonance_hz = 0.0;         ///< 0: none
  double damping_ratio = 0.05;
  std::vector<double> creep_gains;
  std::vector<double> creep_time_s;
  double noise_rms = 0.0;  ///< of y
  std::uint64_t seed = 1;

  /// The stages of the five papers as far as they print them (000 section V.A, 001 III, 002 Table 1, 004
  /// section 4).
  static VirtualStageSettings nanopositioner();  ///< 000: 6.92 um, 65.1 kHz, damped
  static VirtualStageSettings stack_actuator();  ///< 001: 67.66 um at 150 V, 10 kHz
  static VirtualStageSettings pusher();          ///< 002: 12 um at 100 V, 3.5 kHz
  static VirtualStageSettings
  piezoceramic();  ///< 004: 36 um at 120 V, loops that widen and shrink with the rate
};

class VirtualStage {
 public:
  explicit VirtualStage(VirtualStageSettings settings);
  /// Rests at u after a long time there, come up from 0. Returns the measured y.
  double reset(double u);
  double step(double u, double dt_s);
  const VirtualStageSettings& settings() const { return settings_; }

 private:
  /// First-order section k (s + z)/(s + p) for inputs linear between samples.
  struct Section {
    double p = 1.0, gap = 0.0, gain = 1.0;  ///< gain (1 + (z − p)/(s + p))
    double x = 0.0;
    double move(double from, double to, double dt);
    double rest(double u);
  };
  double memory(double x);
  double measured(double y);

  VirtualStageSettings settings_;
  std::vector<Section> rate_;
  std::vector<Section> creep_;
  Section amplifier_;
  bodesmith::Random random_;
  double x_ = 0.0;
  double h_ = 0.0;
  double drive_ = 0.0;
  double q_ = 0.0;
  std::vector<double> between_;
  double place_ = 0.0,
         speed_ = 0.0;  ///< of the mass; its speed in parts of the resonance's angular frequency
  double force_ = 0.0;
  double prepared_ = -1.0;  ///< the step that motion_ is of
  std::array<double, 16>
      motion_{};  ///< exp of the mass under a force that is straight over the step, row by row
};

}  // namespace bench
