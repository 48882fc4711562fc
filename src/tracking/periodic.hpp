#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "tracking/types.hpp"
#include "tracking/waveforms.hpp"

namespace bodesmith::tracking {

/// Steady state of one design at one frequency, harmonic by harmonic (samples over one period from theta =
/// 0).
struct PeriodicState {
  std::vector<double> compensation;  ///< c
  std::vector<double> displacement;  ///< y/stroke
};

/// Spectra of x, w_a, w_d at one frequency, shared by all designs. Keeps references to plant and options.
class PeriodicTracking {
 public:
  PeriodicTracking(const Plant& plant, const Options& options, Hertz frequency);

  /// Clocked branches: with their smooth share (hold and delay, no images), or left out (to be added in the
  /// time domain).
  enum class Clocked { smooth, left_out };
  PeriodicState solve(const Design& design, Clocked clocked = Clocked::smooth) const;

  Hertz frequency() const { return frequency_; }
  const std::vector<double>& reference() const { return x_; }
  /// What the stage adds, k_a w_a + k_d w_d, for the reference as argument.
  const std::vector<double>& stage_disturbance() const { return stage_; }

 private:
  using Spectrum = std::vector<std::complex<double>>;
  Spectrum compensated(const Compensator& compensator, Spectrum waveform, Clocked clocked) const;
  Spectrum compensation(const Design& design, Clocked clocked) const;
  /// What the stage adds to the drive v.
  Spectrum stage_spectrum(const Spectrum& v) const;

  const Plant& plant_;
  const Options& options_;
  Hertz frequency_;
  std::size_t n_;
  Waveforms generator_;
  Waveforms own_;
  double gain_[2];
  std::vector<double> x_;
  std::vector<double> stage_;
  Spectrum x_hat_, ascending_hat_, descending_hat_, stage_hat_;
  Spectrum drive_, path_;  // D and P at the harmonics
};

}  // namespace bodesmith::tracking
