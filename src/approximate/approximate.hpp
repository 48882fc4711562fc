#pragma once

#include <optional>
#include <string>
#include <vector>

#include "approximate/method.hpp"
#include "base/json_fwd.hpp"
#include "lti/cascade.hpp"
#include "lti/fractional_lead_lag.hpp"
#include "lti/sections.hpp"

namespace bodesmith {

/// Difference between sections and the fractional response they stand for.
struct ApproximationError {
  Band band;
  double band_db = 0.0;        ///< largest |magnitude error| over the band
  double band_deg = 0.0;       ///< largest |phase error| over the band
  double everywhere_db = 0.0;  ///< over all frequencies, 0 and infinity included
  double everywhere_deg = 0.0;
  Hertz worst;  ///< where everywhere_db is met (0 and infinity are given as the ends of the grid)
};

struct TermApproximation {
  FractionalLeadLag term;
  int order = 0;
  std::vector<Section> sections;  ///< together the term's approximation, gain included
  ApproximationError error;       ///< over the term's own corners
  /// What no approximation of this order can beat (closed form, see limit_law.hpp), in dB; 0 for a whole
  /// beta.
  double limit_law_db = 0.0;
};

struct ApproximationOptions {
  std::string method = "minimax";
  /// Poles of each term's approximation, whole powers counted inside it.
  std::optional<int> order{};
  /// Without `order`: the fewest poles in all with which the whole cascade stays within this, over all
  /// frequencies.
  std::optional<double> max_error_db{};
  int max_order = 12;      ///< of one term, when searching
  bool real_roots = true;  ///< see ApproximationTask
  bool over_band = false;
};

struct CascadeApproximation {
  Sections sections;                     ///< with its `error` filled in
  std::vector<TermApproximation> terms;  ///< terms with beta = 0 are passed over
  ApproximationError error;
  bool limit_met = true;  ///< false when max_error_db was asked for and could not be met up to max_order
  std::string method;
  double max_error_db = 0.0;  ///< as asked, 0 when not

  /// Extra fields beside the sections: method, order and error of every term, the limit law, phase
  /// everywhere.
  Json report_json() const;
};

/// Throws InputError for an unknown method, an order outside 1..40; DesignError when the method refuses.
TermApproximation approximate_term(const FractionalLeadLag& term, const ApproximationOptions& options,
                                   int order);

/// Integer sections for a whole cascade. With neither order nor max_error_db: order 4 a term.
CascadeApproximation approximate_cascade(const Cascade& cascade, const ApproximationOptions& options = {});

/// Compares sections with a cascade over its corner band and everywhere.
ApproximationError approximation_error(const Sections& sections, const Cascade& cascade);

}  // namespace bodesmith
