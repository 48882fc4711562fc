#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/registry.hpp"
#include "lti/frequency_grid.hpp"
#include "synthesis/circuit.hpp"

namespace bodesmith::synthesis {

/// What decks are asked for.
struct DeckRequest {
  const Circuit& circuit;
  std::string title;
  Band band;  ///< of the small-signal and noise decks; the transient's triangle is at its middle
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
  /// Every file it needs besides compensator.sub, which the decks include.
  virtual std::vector<Deck> decks(const DeckRequest& request) const = 0;
  /// A part's value with its tolerance, where the simulator draws values by itself.
  virtual std::optional<std::string> value_with_tolerance(const schematic::Part&) const {
    return std::nullopt;
  }
};

/// All of them, in the order of the documentation.
Registry<Dialect>& dialect_registry();

/// A list of lines that a template repeats: {{#name}}{{line}}{{/name}}.
struct TemplateLines {
  std::string name;
  std::vector<std::string> lines;
};

/// The deck `file` from templates/spice/FILE, with the request's title, band, triangle and tolerances.
Deck deck_from_template(const std::string& file, const DeckRequest& request,
                        const std::vector<TemplateLines>& lists = {});

/// Two periods of a triangle of 0 to 1 V as the points of a PWL source.
std::string triangle_points(double frequency_hz);

}  // namespace bodesmith::synthesis
