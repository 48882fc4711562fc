#pragma once

#include <optional>
#include <string>
#include <vector>

#include "approximate/term.hpp"
#include "base/json_fwd.hpp"
#include "lti/cascade.hpp"

namespace bodesmith {

struct CascadeApproximation {
  Sections sections;                     ///< with its `error` filled in
  std::vector<TermApproximation> terms;  ///< terms with beta = 0 are passed over
  ApproximationError error;
  bool limit_met = true;  ///< false when max_error_db was asked for and could not be met up to max_order
  std::string method;
  std::optional<double> max_error_db;  ///< as asked

  /// Extra fields beside the sections: method, order and error of every term, the limit law, phase
  /// everywhere.
  Json report_json() const;
};

/// Integer sections for a whole cascade. With neither order nor max_error_db: order 4 a term. A cascade that is a plain
/// gain becomes that gain without sections. Throws DesignError when the method refuses.
CascadeApproximation approximate_cascade(const Cascade& cascade, const ApproximationOptions& options = {});

}  // namespace bodesmith
