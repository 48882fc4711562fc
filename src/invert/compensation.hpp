#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/provenance.hpp"
#include "chain/chain.hpp"
#include "invert/drive_search.hpp"
#include "signal/time_record.hpp"

namespace bodesmith::invert {

/// The drive that makes a chain follow a reference, and how well it does.
struct Compensation {
  std::vector<double> drive;
  std::vector<double> predicted;  ///< what simulate() says of the drive: the same options, the same bytes
  std::optional<double> error_estimate;      ///< of that simulation
  int steps = 0;                             ///< of the search, beyond the inverse by structure
  double delay_s = 0.0;                      ///< all delays of the chain, holds included
  std::vector<std::string> without_inverse;  ///< blocks whose inverse was found numerically only
  std::vector<OutOfReach> out_of_reach;
  std::size_t samples_out_of_reach = 0;
};

/// Inverts the chain block by block from its output back (BlockType::inverse), each block's wanted output the next
/// one's found input, on the samples of the reference. What is left after that (dynamics between samples, several
/// nonlinear blocks, limits) goes by iterative learning on the chain's own simulation: the drive is moved by the
/// answer of the chain's local linear model to the error (chain::LocalChain; Gauss-Newton with secant slopes for
/// operators with memory), each move kept only if the simulated error falls. Throws DesignError when there is no
/// drive under which the output stays finite.
Compensation compensate(const chain::Chain& chain, const TimeRecord& reference, const Options& options);

/// The record as a reader of its printed times sees it.
TimeRecord as_read_back(TimeRecord record);

/// From which sample on an error is that of tracking, not of starting.
struct SteadyState {
  std::size_t first = 0;
  std::string why;
};
/// The last whole period of a reference that repeats; otherwise everything behind the first sample, the chain's
/// delays and, from states that are zero, what it takes to forget them (half the record at most). With `skip_s`
/// whatever comes later than that.
SteadyState steady_state_of(const chain::Chain& chain, const TimeRecord& reference, const Options& options,
                            std::optional<double> skip_s);

/// inverse.toml (`bodesmith.inverse/1`): a model to invert and how, for any reference that comes.
///   schema = "bodesmith.inverse/1"
///   model = "model.toml"     # relative to this file
///   start = "equilibrium"    # or "zero"; absent: as the model says, equilibrium where it does not
///   preview = true           # delays are made good by looking ahead
///   lower = 0.0              # limits of the drive; absent: none
///   upper = 1.2
///   max_rate_per_s = 500.0
///   bandwidth_hz = 1e3
struct InverseFile {
  chain::Chain model;
  Options options;

  /// Errors name file and line.
  static InverseFile read(const std::filesystem::path& path, Provenance& from);
  /// Its text; `model` as it is to stand there.
  static std::string text(const std::string& model, const Options& options);
};

}  // namespace bodesmith::invert
