#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "lti/state_space.hpp"
#include "numeric/preview_tracking.hpp"

namespace bodesmith::chain {

/// A state space from sample to sample for an input that is a straight line between them:
///   x' = phi x + from u + to u',   y = c x + d u.
struct SampledSystem {
  Eigen::MatrixXd phi;
  Eigen::VectorXd from;
  Eigen::VectorXd to;
  Eigen::VectorXd c;
  double d = 0.0;
};
/// Exact, by one matrix exponential. Constants and offsets are left out.
SampledSystem sampled(const StateSpace& system, double step_s);

/// |H| at the slowest sine that a record holds: what a drive does there, also where at rest it does nothing (a high-pass) or without
/// end (an integrator).
double slowest_gain(const StateSpace& system, double step_s, std::size_t samples);

/// What a drive may be.
struct DriveLimits {
  std::optional<double> lower;
  std::optional<double> upper;
  std::optional<double> max_rate_per_s;

  bool any() const { return lower || upper || max_rate_per_s; }
  /// Whether u keeps to them, but for rounding.
  bool kept(std::span<const double> u, double step_s) const;
  /// u moved to within the limits: clamped, then half way between the slow signals just below and just above.
  void hold(std::span<double> u, double step_s) const;
};

/// What a change of the drive shall do at the samples of a record.
struct LocalGoal {
  std::vector<double> change;  ///< of the output
  std::vector<double> weight;  ///< of each sample; 0: its output does not matter
  std::vector<double> drive;   ///< what is changed
  double gain = 1.0;           ///< size of the chain's slope: what the weights below are relative to
  double smoothing = 3e-4;  ///< a second difference of the drive costs smoothing² gain² of an output error
  bool from_rest = true;    ///< at rest under the first input; otherwise from states that are zero
  DriveLimits limits;       ///< of drive + change
};

/// A chain as it answers small changes of its input, from sample to sample: linear systems, and slopes that may be
/// others at every sample. Delays are not part of it.
class LocalChain {
 public:
  LocalChain(double step_s, std::size_t samples) : step_s_(step_s), samples_(samples) {}
  void add(SampledSystem system);
  void add(std::vector<SampledSystem> one_a_step);
  /// One slope, or one a sample.
  void add(std::vector<double> slopes);
  std::size_t order() const;

  /// The change of the drive that comes nearest to the goal, limits and curvature weighed in; the whole record is
  /// known, and worked out in windows that overlap where it is long.
  std::vector<double> change_for(const LocalGoal& goal) const;

 private:
  using Systems = std::vector<SampledSystem>;
  using Element = std::variant<Systems, std::vector<double>>;
  bool varies() const;
  PreviewSystem system(std::size_t first, std::size_t count) const;
  Eigen::VectorXd at_rest() const;

  double step_s_;
  std::size_t samples_;
  std::vector<Element> elements_;
};

}  // namespace bodesmith::chain
