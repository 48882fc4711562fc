#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "fpaa/network/switched_network.hpp"

namespace bodesmith::fpaa {

/// A switched network with its clocks: the linear maps between its switching instants. Clock k has phase 1 in
/// the first half of its period of `ticks[k]` (even) ticks and phase 2 in the second; all begin at 0. Within
/// interval i, which begins at start[i],
///   V(t) = C q + D u(t),                      q: charges at its beginning
///   q of the next interval = M q + N u(end),
/// cyclic over `period`, the common period of the clocks. Slow op-amps and switches leave what is stored, S,
/// behind by late dS/dt (ChargeMap::late), in which a step is an impulse of that area.
class ClockedNetwork {
 public:
  struct Interval {
    std::int64_t start = 0;
    Eigen::MatrixXd c, d, m, n;
    /// Of slow op-amps and switches: what the output that is read stays behind is -(behind_q dq/dt + behind_u du/dt), where a step
    /// from an interval to the next is one from the last interval's behind_last to the own; -late_n du/dt(end) is in the next q.
    Eigen::RowVectorXd behind_q, behind_u, behind_last_q, behind_last_u;
    Eigen::MatrixXd late_n;
    Eigen::MatrixXd noise;  ///< covariance of what noise adds to the next q (kT times the unit)
    /// Of op-amps with a noise of their own, at the output that is read, each in kT over the unit: the two-sided density while no
    /// switch moves, s, and the covariance of its integral about the interval's end with what is added to the next q.
    double direct_noise_s = 0.0;
    double slowest_s = 0.0;  ///< longest time constant of theirs
    Eigen::VectorXd noise_about_end_s;
  };

  /// Throws DesignError where a position of the switches leaves a voltage open, or where the common period has
  /// more than `kMostInstants` switching instants.
  ClockedNetwork(const SwitchedNetwork& network, std::vector<std::int64_t> ticks, bool with_noise = false);

  static constexpr std::int64_t kMostInstants = 2000000;

  std::int64_t period() const { return period_; }
  const std::vector<Interval>& intervals() const { return intervals_; }
  std::size_t inputs() const { return inputs_; }
  bool is_late() const { return intervals_.front().late_n.size() > 0; }
  bool has_noise() const { return intervals_.front().noise.size() > 0; }
  std::size_t opamps() const { return opamps_; }
  /// Index of the op-amp that is read outside.
  std::size_t output() const { return output_; }

 private:
  void add_lateness(Interval& interval, const ChargeMap& here, const ChargeMap& last,
                    const Eigen::MatrixXd& sums) const;
  void add_noise(Interval& interval, const ChargeMap& here, const ChargeMap& next,
                 const Eigen::MatrixXd& sums) const;

  std::int64_t period_ = 1;
  std::size_t inputs_ = 0, opamps_ = 0, output_ = 0;
  std::vector<Interval> intervals_;
};

/// Least common multiple; nothing where it is beyond 2^62.
std::optional<std::int64_t> common_period(std::span<const std::int64_t> periods);

}  // namespace bodesmith::fpaa
