#pragma once

#include <optional>
#include <string>
#include <vector>

#include "chain/chain.hpp"
#include "signal/time_record.hpp"

namespace bodesmith::measured {

/// A part that may be off, by how much.
struct Suspect {
  std::string part;
  std::string unit;  ///< "percent" or "v"
  double departure = 0.0;
  double tolerance = 0.0;

  bool within_tolerance() const;
  /// "Rd3 is 8.0 % above its value".
  std::string words() const;
};

/// The part that was named and, least departure first, those that explain the record as well: parts of which only a ratio
/// shows, or that do the same at the record's frequency. `base`: before anything was found, with the tables of its parts.
std::vector<Suspect> suspects_of(const chain::Chain& found, const chain::Chain& base, const std::string& part,
                                 double departure, const TimeRecord& record);

/// The record that tells suspects apart best: the same shape at another frequency of the rate gains' table.
struct Separating {
  double frequency_hz = 0.0;
  double rms = 0.0;  ///< least difference of two suspects' records, of the record's own unit
};
/// Over the table of the block whose parts they are and the middles between its frequencies; nothing where there is none.
std::optional<Separating> separating_record(const chain::Chain& base, const std::vector<Suspect>& suspects,
                                            const TimeRecord& record, double operating_hz);

/// What good parts and noise make of a record.
struct GoodParts {
  double further =
      0.0;  ///< departure of the part that is wrong beyond the chain's, of its unit (what was fitted without the others' took their share)
  double squares =
      0.0;  ///< of what is left in rms of noise, and of all departures in standard deviations: -2 ln of how likely
};

/// Whether noise of that rms and parts within their tolerances make all that the chain leaves of the record: the least `squares`,
/// where they leave no more than noise. `wrong`: a part that may be off by more.
std::optional<GoodParts> good_parts_explain(const chain::Chain& chain, const TimeRecord& record,
                                            double noise_rms, const std::string& wrong = {});

/// Whether they do so with `chain`, and not plainly less likely than with `other`: an amplifier that is too slow for its record shows at
/// the turns what no part does, however little that is beside the rest of its lag.
bool good_parts_do_as_much(const chain::Chain& chain, const chain::Chain& other, const TimeRecord& record,
                           double noise_rms);

}  // namespace bodesmith::measured
