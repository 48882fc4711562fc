#include "approximate/approximate.hpp"
#include "base/json.hpp"

namespace bodesmith {

Json CascadeApproximation::report_json() const {
  Json out;
  out["method"] = method;
  if (max_error_db) out["max_error_db"] = *max_error_db;
  out["limit_met"] = limit_met;
  out["everywhere_max_magnitude_db"] = error.everywhere_db;
  out["everywhere_max_phase_deg"] = error.everywhere_deg;
  out["worst_hz"] = error.worst.value;
  out["terms"] = Json::array();
  for (const TermApproximation& term : terms) {
    out["terms"].push_back({{"lambda_s", term.term.lambda_s},
                            {"x", term.term.x},
                            {"beta", term.term.beta},
                            {"order", term.order},
                            {"max_magnitude_db", term.error.band_db},
                            {"max_phase_deg", term.error.band_deg},
                            {"everywhere_max_magnitude_db", term.error.everywhere_db},
                            {"everywhere_max_phase_deg", term.error.everywhere_deg},
                            {"limit_law_db", term.limit_law_db}});
  }
  return out;
}

}  // namespace bodesmith
