#pragma once

#include <complex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/units.hpp"
#include "chain/block.hpp"
#include "chain/trained.hpp"

namespace bodesmith::chain {

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
  std::optional<std::complex<double>> response(RadPerSecond w) const;
  /// Every free parameter, in chain order. Pointers stay good until blocks or list lengths change.
  std::vector<Parameter*> free_parameters();
  /// "block 2 (lowpass) corner_hz", "block 2 (lowpass, amplifier) corner_hz" of one with a name, for messages and summaries; blocks count from 1.
  std::string label(const Parameter& parameter) const;
};

}  // namespace bodesmith::chain
