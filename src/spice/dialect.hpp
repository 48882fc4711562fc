#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/registry.hpp"
#include "circuit/circuit.hpp"
#include "circuit/parts/tolerances.hpp"
#include "lti/frequency_grid.hpp"

namespace bodesmith::spice {

/// What the Monte Carlo decks run.
struct MonteCarloOptions {
  circuit::Tolerances tolerances;
  int runs = 100;
  unsigned seed = 1;
};

/// What decks are asked for.
struct DeckRequest {
  const circuit::Circuit& circuit;
  std::string title;
  Band band;  ///< of the small-signal and noise decks; the transient's triangle is at its middle
  MonteCarloOptions monte_carlo;
};

struct Deck {
  std::string file;
  std::string text;
};

/// A simulator's own way to write what the portable library (compensator.sub) leaves to it: the decks around
/// it, with their analyses, measurements and Monte Carlo runs.
class Dialect {
 public:
  virtual ~Dialect() = default;
  virtual std::string_view name() const = 0;
  /// Every file it needs beside compensator.sub, which the decks include.
  virtual std::vector<Deck> decks(const DeckRequest& request) const = 0;
  /// A part's value with its tolerance, where the simulator draws values by itself.
  virtual std::optional<std::string> value_with_tolerance(const schematic::Part&) const {
    return std::nullopt;
  }
};

/// All of them, in the order of the documentation.
Registry<Dialect>& dialect_registry();

}  // namespace bodesmith::spice
