#pragma once

#include <complex>
#include <vector>

#include "tracking/tracking.hpp"
#include "tracking/waveforms.hpp"

namespace bodesmith::tracking {

/// Steady state of one design at one frequency, harmonic by harmonic (samples over one period from theta =
/// 0).
struct PeriodicState {
  std::vector<double> compensation;  ///< c
  std::vector<double> displacement;  ///< y/stroke
};

/// Spectra of x, w_a, w_d at one frequency, shared by all designs.
class PeriodicTracking {
 public:
  PeriodicTracking(const TrackingPlant& plant, const TrackingOptions& options, Hertz frequency);

  /// `with_clocked` false leaves the compensation of clocked branches out (it is then added in the time
  /// domain).
  PeriodicState solve(const TrackingDesign& design, bool with_clocked = true) const;

  std::size_t samples() const { return n_; }
  const std::vector<double>& reference() const { return x_; }
  /// What the stage adds, k_a w_a + k_d w_d, for the reference as argument.
  const std::vector<double>& stage_disturbance() const { return stage_; }

 private:
  const TrackingPlant& plant_;
  const TrackingOptions& options_;
  Hertz frequency_;
  std::size_t n_;
  TrackingWaveforms generator_;
  TrackingWaveforms own_;
  double gain_[2];
  std::vector<double> x_;
  std::vector<double> stage_;
  std::vector<std::complex<double>> x_hat_, ascending_hat_, descending_hat_, stage_hat_;
  std::vector<std::complex<double>> drive_, path_;  // D and P at the harmonics
};

/// The frequency response by which a compensator acts on a waveform; for a clocked one with or without hold
/// and delay.
std::complex<double> compensator_response(const Compensator& compensator, RadPerSecond w);

/// Delay of the reference that makes the rms of y - x(t - lag) smallest, and that rms. Both sampled over one
/// period of `period_s`; lengths powers of two.
struct LagResult {
  double lag_s = 0.0;
  double rms = 0.0;
};
LagResult best_lag(const std::vector<double>& y, const std::vector<double>& x, double period_s);

}  // namespace bodesmith::tracking
