#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "tracking/compensator.hpp"
#include "tracking/reference.hpp"
#include "tracking/types.hpp"

namespace bodesmith::tracking {

/// Steady state of one design at one frequency, evenly sampled over one repeat of the reference.
struct PeriodicState {
  std::vector<double> compensation;        ///< c = x - v
  std::vector<double> drive;               ///< v
  std::vector<double> displacement;        ///< y/stroke
  std::vector<std::vector<double>> heard;  ///< what each pass of the generator works on; the loop: v
};

/// One reference at one frequency, shared by all designs: the nonlinear parts sample by sample, compensators
/// harmonic by harmonic, paths from sample to sample (settled_path()). Keeps references to plant and options.
class PeriodicTracking {
 public:
  PeriodicTracking(const Plant& plant, const Options& options, Hertz frequency);

  /// DesignError when a loop round the generator does not settle.
  PeriodicState solve(const Design& design) const;

  Hertz frequency() const { return frequency_; }
  const Reference& form() const { return shape_; }
  /// Seconds of one repeat.
  double repeat_s() const { return static_cast<double>(shape_.periods()) / frequency_.value; }
  const std::vector<double>& reference() const { return x_; }
  /// Of the samples above: whether the reference rises.
  /// What the stage adds: k_b d_b of the reference, or of its drive, as the options say.
  std::vector<double> stage_disturbance(const std::vector<double>& drive) const {
    return stage_disturbance(drive, options_.argument);
  }
  /// y/stroke under a drive v of a stage that reads `argument`.
  std::vector<double> displacement(const std::vector<double>& drive, Options::Argument argument) const;
  /// What goes into a branch's compensator when the generator works on h.
  std::vector<double> branch_waveform(std::size_t branch, const std::vector<double>& heard) const;

 private:
  /// A branch's compensator at this frequency, worked out once for all rounds: the response at the harmonics, or the
  /// gain sample by sample; neither: it gives nothing.
  struct Prepared {
    std::vector<Complex> response;
    std::vector<double> gain;
  };
  using Both = std::array<Prepared, 2>;
  Prepared prepared(const Compensator& compensator) const;
  std::vector<double> compensated(const Prepared& compensator, std::size_t branch,
                                  const std::vector<double>& heard) const;
  std::vector<double> compensation(const Both& compensators, const std::vector<double>& heard) const;
  std::vector<double> stage_disturbance(const std::vector<double>& drive, Options::Argument argument) const;
  /// About dc/dv at every sample: k d', with a filter's gain at the operating frequency for k.
  std::vector<double> loop_gain(const Both& compensators, const std::vector<double>& heard) const;
  std::vector<double> self_fed_drive(const Design& design, const Both& compensators) const;

  const Plant& plant_;
  const Options& options_;
  Hertz frequency_;
  Reference shape_;
  std::size_t n_;
  Disturbance generator_;
  Disturbance own_;
  std::vector<double> x_;
  std::vector<bool> rising_;
  std::vector<bool> corner_;
};

/// What a SlopeGain's slope detector holds over one repeat of the reference, in steady state, evenly sampled.
struct MeasuredSlope {
  std::vector<double> slope;         ///< s, 1/s
  std::vector<double> smoothed;      ///< m, 1/s; |s| without smoothing
  std::vector<double> frequency_hz;  ///< m/(2 alpha)
};
MeasuredSlope measure_slope(const SlopeGain& gain, const Reference& reference, Hertz operating,
                            std::size_t samples);

}  // namespace bodesmith::tracking
