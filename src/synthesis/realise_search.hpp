#pragma once

#include <optional>
#include <string>
#include <vector>

#include "schematic/opamp_library.hpp"
#include "synthesis/opamp_check.hpp"
#include "synthesis/realise.hpp"

namespace bodesmith::synthesis {

/// What a circuit must keep to be worth building.
struct BuildLimits {
  double min_phase_margin_deg = 30.0;
  double max_error_db = 3.0;  ///< of parts and op-amps together, in judged_band()
};

/// A circuit, what its op-amps do in it, and where it falls short.
struct Candidate {
  std::string realisation;
  std::string how;  ///< for a person: "cauer1", "opamp-rc with isolating resistors"
  Realised made;
  OpAmpCheck opamps;
  ResponseDifference judged;  ///< parts and op-amps against the sections in the band below
  Band judged_band;
  std::vector<std::string> shortfalls;  ///< of BuildLimits; empty: it can be built
};

struct BuildSearch {
  RealiseOptions options;
  BuildLimits limits;
  bool may_choose = false;    ///< other realisations may take the place of options.realisation
  bool limits_given = false;  ///< the limits of the parts are somebody's, not the realisation's own
  /// The types to choose from, cheapest first; none: options.opamp.
  const schematic::OpAmpLibrary* opamps = nullptr;
  double amplitude_v = 1.0;
};

struct BuildChoice {
  Candidate best;
  std::vector<std::string> passed_over;  ///< "opamp-rc: stage 2 cannot be made …"
};

/// The realisation that was asked for; where that cannot be made or falls short and the choice is free, the one of all that
/// falls short least. A Refusal names the limit of resistors or capacitors with which it would do.
Outcome<BuildChoice> realise_for_building(const Sections& sections, const BuildSearch& search);

/// "capacitors up to 1u": the single limit, moved the least, with which the realisation can be made; the widest ones together
/// where no single one does; nothing when not even they do.
std::optional<std::string> limits_that_do(const Sections& sections, const RealiseOptions& options);

}  // namespace bodesmith::synthesis
