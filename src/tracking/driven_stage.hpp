#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "lti/state_space.hpp"
#include "tracking/types.hpp"

namespace bodesmith::tracking {

/// Reference, slope detectors, generator (its passes, or the loop), drive path and stage path of one design at one
/// frequency as an ODE between two turning points of the reference. States in that order:
///   per branch with a SlopeGain: s (and m where it is smoothed);  per pass: ascending, descending compensator;
///   drive path; stage path.
class DrivenStage {
 public:
  /// Nothing when the design has a part with no time domain (a response without approximation, a clocked
  /// compensator), or the stage is of another family.
  static std::optional<DrivenStage> of(const Plant& plant, const Design& design, const Options& options,
                                       Hertz frequency);

  std::size_t order() const { return order_; }
  const Reference& reference() const { return reference_; }
  double repeat_s() const { return repeat_s_; }

  void enter_piece(std::size_t piece) { piece_ = piece; }
  /// The branch of a stage that reads its drive.
  void turn_drive(bool rising) { drive_rising_ = rising; }
  bool drive_rises() const { return drive_rising_; }
  bool reads_drive() const { return on_drive_; }

  struct Outputs {
    double drive = 0.0;        ///< u, what the stage reads
    double drive_slope = 0.0;  ///< du/dt
    double displacement = 0.0;
  };
  /// Rates of all states into dx.
  Outputs evaluate(double theta, const double* x, double* dx) const;

  /// The linear blocks on their own, in the order of their states.
  const std::vector<StateSpace>& blocks() const { return blocks_; }
  /// Index of the first filter of a pass in blocks(); drive and stage path are the last two.
  const SlopeGain* detector(std::size_t branch) const { return slope_[branch] ? &*slope_[branch] : nullptr; }

 private:
  /// Gains of the branches, k and dk/dt, from the slope detectors.
  struct Gains {
    std::array<double, 2> k = {1.0, 1.0};
    std::array<double, 2> slope = {0.0, 0.0};
  };
  struct Wave {
    double value = 0.0;
    double slope = 0.0;  ///< by time
  };

  DrivenStage(const Plant& plant, const Options& options, Hertz frequency);
  Gains measured_gains(double reference_slope, const double* x, double* dx) const;
  /// c of one pass that hears `heard`; rates of its filters into dx.
  Wave compensation(const Gains& gains, const Wave& heard, const double* x, double* dx,
                    std::size_t first) const;
  Wave self_fed(const Gains& gains, const Wave& reference, const double* x, double* dx) const;
  bool switched_on(std::size_t branch) const { return Reference::rises(piece_) == (branch == 0); }
  bool filter_hears(std::size_t branch) const { return before_switch_ || switched_on(branch); }
  bool filter_counts(std::size_t branch) const { return !before_switch_ || switched_on(branch); }

  Reference reference_;
  Disturbance generator_;
  Disturbance own_;
  double repeat_s_;
  bool before_switch_;
  bool on_drive_;
  bool self_fed_ = false;
  std::size_t passes_ = 1;
  std::size_t detectors_ = 0;  ///< blocks of slope detectors
  std::array<std::optional<SlopeGain>, 2> slope_;
  std::vector<StateSpace> blocks_;
  std::vector<std::size_t> at_;  ///< where each block's states begin
  std::size_t order_ = 0;
  std::size_t piece_ = 0;
  bool drive_rising_ = true;
};

}  // namespace bodesmith::tracking
