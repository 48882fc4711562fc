#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "lti/frequency_grid.hpp"
#include "lti/sections.hpp"
#include "synthesis/circuit.hpp"
#include "synthesis/parts/series.hpp"

namespace bodesmith::synthesis {

/// Parts that may be used.
struct PartLimits {
  double min_ohm = 1e3;
  double max_ohm = 2.2e6;
  double min_f = 47e-12;
  double max_f = 220e-9;

  /// A value typed as a limit is itself allowed, whatever its last bit.
  bool allow(Part::Kind kind, double value) const {
    const bool resistor = kind == Part::Kind::resistor;
    return value >= (resistor ? min_ohm : min_f) * (1.0 - 1e-9) &&
           value <= (resistor ? max_ohm : max_f) * (1.0 + 1e-9);
  }
  /// Throws InputError where a range is empty.
  void validate() const;
};

struct RealiseOptions {
  /// A name in realisation_registry(): "opamp-rc" chooses a form for every stage.
  std::string realisation = "opamp-rc";
  Series resistors = Series::named("E96");
  Series capacitors = Series::named("E12");
  /// Parts outside these are not used: a corner that cannot be reached with them is refused.
  PartLimits limits;
  schematic::Tolerances tolerances;  ///< of what is bought; nothing is designed by them
  OpAmpModel opamp;
  /// In series with every C1 of a first-order stage, so that the op-amp before it does not ring. Without a
  /// value: a fifth of the op-amp's output resistance, none with exact parts, or where that would take more
  /// than 0.005 dB within the band.
  std::optional<double> isolation_ohm;
  /// Where the realised response is compared; default: 1/10 of the lowest to 10 times the highest corner.
  std::optional<Band> band;
};

/// Realised against wanted, over `band`.
struct RealiseReport {
  Band band;
  ResponseDifference parts;    ///< preferred values, ideal op-amps, against the sections
  ResponseDifference nearest;  ///< the same with every value rounded on its own (what joint search saves)
  ResponseDifference
      opamps;  ///< finite gain-bandwidth and output resistance (loading included), against ideal ones
  ResponseDifference all;        ///< real parts and real op-amps against the sections
  double highest_node_db = 0.0;  ///< max. |gain| from the input to any stage's output, over frequency
  double lowest_node_db = 0.0;   ///< min. of the stages' output gains over frequency
  std::vector<std::string> warnings;
};

struct Realised {
  Circuit circuit;
  RealiseReport report;
};

/// Without the zeros that lie more than 1000 times above the highest pole (a fit's way to say that there is
/// none): below ten times that pole they count for less than 0.0005 dB and 0.6 degrees, and would take parts
/// that cannot be had. The gain at rest is kept.
Sections without_far_zeros(const Sections& sections);

/// Fills made.report for made.circuit; `nearest` is the response with every value rounded on its own.
void report_realised(Realised& made, const Sections& sections, Band band,
                     const std::function<Complex(RadPerSecond)>& nearest);

/// Sections as a circuit, by options.realisation (realisation.hpp). Throws InputError for options that cannot
/// be meant; a design that cannot be made is a Refusal.
Outcome<Realised> try_realise(const Sections& sections, const RealiseOptions& options = {});
/// The same for the edge of the library: throws DesignError.
Realised realise(const Sections& sections, const RealiseOptions& options = {});

}  // namespace bodesmith::synthesis
