#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/units.hpp"
#include "chain/block.hpp"
#include "signal/time_record.hpp"

namespace bodesmith::chain {

/// What a model was fitted to and how well it did: the table [trained] of model.toml. Beyond it the model says
/// nothing that was ever compared with anything.
struct Trained {
  SignalExtent input;
  double output_lower = 0.0;
  double output_upper = 0.0;
  double training_rms = 0.0;
  double training_percent = 0.0;  ///< of range, see signal/statistics.hpp
  std::optional<double> holdout_rms;
  std::optional<double> holdout_percent;

  /// The error to count with: of held-out records where there were any.
  double rms() const { return holdout_rms.value_or(training_rms); }
  /// In which respects a drive goes beyond the training records', a sentence each; an output beyond theirs, too.
  std::vector<std::string> beyond(const SignalExtent& drive, double least_output, double most_output) const;
  /// Not empty: the drive leaves the training records' range by more than a tenth of it, and how. There a cubic that
  /// fits to within e may be off by 3.3 e (T3(1.2), Chebyshev's bound); farther out nothing holds it.
  std::string far_beyond(const SignalExtent& drive) const;
};

/// The keys that a table [trained] of model.toml has to have.
std::vector<std::string> needed_trained_keys();

/// The state of a chain before the first sample.
enum class Start {
  zero,         ///< every state is zero
  equilibrium,  ///< at rest under the first input
};
/// "zero", "equilibrium".
constexpr std::string_view to_string(Start start) {
  return start == Start::equilibrium ? "equilibrium" : "zero";
}

/// Blocks in series, input first.
struct Chain {
  std::vector<Block> blocks;
  /// Of identified models.
  std::optional<Trained> trained = std::nullopt;
  /// How it starts where nothing else is asked for; nothing: as each use of it does (zero in a simulation).
  std::optional<Start> start = std::nullopt;

  /// Product of the blocks' exact responses; nothing when one of them is not linear.
  std::optional<Complex> response(RadPerSecond w) const;
  /// "block 2 (lowpass) corner_hz", "block 2 (lowpass, amplifier) corner_hz" of one with a name, for messages and summaries; blocks count from 1.
  std::string label(const Parameter& parameter) const;
};

}  // namespace bodesmith::chain
