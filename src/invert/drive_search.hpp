#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/units.hpp"
#include "chain/inverse.hpp"
#include "chain/local_chain.hpp"
#include "invert/local_model.hpp"
#include "simulate/record/record_simulator.hpp"
#include "simulate/types.hpp"

namespace bodesmith::invert {

struct Options {
  simulate::Start start = simulate::Start::equilibrium;
  /// Delays are made good by looking ahead in the reference; otherwise they stay in the output.
  bool preview = true;
  chain::DriveLimits limits;
  /// The drive holds nothing above it, but for what the limits make of it.
  std::optional<Hertz> bandwidth;
  int max_steps = 12;
};

/// A part of the reference that no drive reaches, and why.
struct OutOfReach {
  std::string why;
  std::size_t samples = 0;
  double from_s = 0.0;
  double to_s = 0.0;
};

/// The work behind compensate(): a drive, and what the chain makes of it.
class DriveSearch {
 public:
  DriveSearch(const chain::Chain& chain, const TimeRecord& reference, const Options& options);

  /// The inverse by structure, held to limits and bandwidth.
  void by_structure();
  /// Up to `steps` moves, each of which lowers the error of the output that the record engine finds.
  void improve(int steps);
  /// The same, judged by simulate(): the error that will be stated.
  void polish(int steps);

  const std::vector<double>& drive() const { return drive_; }
  double error_rms() const;
  int steps() const { return steps_; }
  double delay_s() const { return delay_s_; }
  const std::vector<std::string>& without_inverse() const { return without_inverse_; }
  /// Of the blocks' own inverses: samples that no input of a block reaches, by block.
  const std::vector<OutOfReach>& refused() const { return refused_; }
  const std::vector<bool>& refused_samples() const { return refused_samples_; }
  simulate::Result simulated(const std::vector<double>& drive) const;

 private:
  using Signals = std::vector<std::vector<double>>;
  /// `first`: notes what has no inverse and what is out of reach.
  std::vector<double> structure_for(const std::vector<double>& aim, bool first);
  chain::FoundInput inverse_of_block(std::size_t index, const chain::WantedOutput& wanted, bool first);
  /// Through the straight line that comes nearest to what the blocks do with the wanted signal itself.
  std::vector<double> by_straight_line(const chain::Chain& blocks, const std::vector<double>& wanted) const;
  std::vector<double> permitted(std::vector<double> u) const;
  std::vector<double> output(const std::vector<double>& u);
  Signals signals(const std::vector<double>& u);
  double cost(const std::vector<double>& u, const std::vector<double>& y) const;
  std::vector<double> change_towards(const std::vector<double>& y);
  template <class Output>
  bool move(const std::vector<double>& change, Output&& judged, double least_gain);
  bool aim_again(double least_gain);

  const chain::Chain& chain_;
  const TimeRecord& reference_;
  Options options_;
  std::vector<chain::Kernel> kernels_;
  simulate::RecordSimulator simulator_;
  double delay_s_ = 0.0;
  std::vector<double> target_;  ///< the reference, later by the delay when there is no preview
  std::vector<double> aim_;     ///< what the inverse by structure was asked for last
  std::vector<double> drive_;
  std::vector<double> output_;
  double gain_ = 1.0;
  double smoothing_ = 3e-4;
  int steps_ = 0;
  std::vector<std::string> without_inverse_;
  std::vector<OutOfReach> refused_;
  std::vector<bool> refused_samples_;
};

/// The signal without what lies above the bandwidth: nothing is late (no phase), gain 1 up to 0.8 of it and then
/// down as a raised cosine; the record is continued by its reflection in its end points.
std::vector<double> band_limited(const std::vector<double>& u, double step_s, Hertz bandwidth);

}  // namespace bodesmith::invert
