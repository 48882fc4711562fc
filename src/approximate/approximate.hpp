#pragma once

#include <optional>
#include <string>
#include <vector>

#include "approximate/approximation_error.hpp"
#include "approximate/method.hpp"
#include "base/documents/json_fwd.hpp"
#include "lti/cascade.hpp"
#include "lti/sections.hpp"

namespace bodesmith {

struct TermApproximation {
  FractionalLeadLag term;
  int order = 0;
  std::vector<Section> sections;  ///< together the term's approximation, gain included
  ApproximationError error;       ///< over the term's own corners
  /// What no approximation of this order can beat (closed form, see minimax_limit_db), in dB; 0 for a whole
  /// beta.
  double limit_law_db = 0.0;
};

struct ApproximationOptions {
  std::string method = "minimax";  ///< a name of method_registry()
  /// Poles of each term's approximation, whole powers counted inside it.
  std::optional<int> order{};
  /// Without `order`: the fewest poles in all with which the whole cascade stays within this, over all
  /// frequencies.
  std::optional<double> max_error_db{};
  int max_order = 12;      ///< of one term, when searching
  bool real_roots = true;  ///< see ApproximationTask
  bool over_band = false;
};

/// A band whose true power is 0 comes out of a fit as a power of rounding's size.
bool is_nothing(const FractionalLeadLag& term);

/// Sections for one term, or why the method makes none of this order. Throws InputError for an unknown method, an order
/// outside 1..40, a term with beta = 0.
Outcome<std::vector<Section>> try_term_sections(const FractionalLeadLag& term,
                                                const ApproximationOptions& options, int order);
/// The same with its error.
Outcome<TermApproximation> try_approximate_term(const FractionalLeadLag& term,
                                                const ApproximationOptions& options, int order);

struct CascadeApproximation {
  Sections sections;                     ///< with its `error` filled in
  std::vector<TermApproximation> terms;  ///< terms with beta = 0 are passed over
  ApproximationError error;
  std::string method;
  std::optional<double> max_error_db;  ///< as asked

  bool limit_met() const { return !max_error_db || error.everywhere_db <= *max_error_db; }

  /// Extra fields besides the sections: method, order and error of every term, the limit law, phase
  /// everywhere.
  Json report_json() const;
};

/// Integer sections for a whole cascade. With neither order nor max_error_db: order 4 a term. A cascade that is a plain
/// gain becomes that gain without sections. Throws DesignError when the method refuses.
CascadeApproximation approximate_cascade(const Cascade& cascade, const ApproximationOptions& options = {});

}  // namespace bodesmith
