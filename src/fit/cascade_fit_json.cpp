#include "base/json.hpp"
#include "fit/cascade_fit.hpp"

namespace bodesmith {

Json CascadeFit::to_json() const {
  Json out = cascade.to_json();
  Json& fit = out["fit"];
  fit["kind"] = bounded ? "bounded" : least_squares ? "least squares" : "interpolation";
  if (fewest_bands) fit["limit_met"] = limit_met;
  if (bounded) {
    fit["beta_bounds"] = {lower_bound, upper_bound};
    fit["optimality_residual"] = optimality_residual;
  }
  fit["base"] = {{"frequency_hz", base.value}, {"got_relative_db", base_got_db}};
  fit["terms"] = Json::array();
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const CascadeFitTerm& term = terms[i];
    fit["terms"].push_back({{"from_hz", term.band.from.value},
                            {"to_hz", term.band.to.value},
                            {"beta", term.beta},
                            {"orientation", term.beta == 0.0 ? "flat"
                                            : term.rises     ? "lead"
                                                             : "lag"},
                            {"slope_db", 20.0 * term.beta},
                            {"at_bound", term.at_bound},
                            {"beta_change_per_gain_percent", sensitivity[i]},
                            {"max_beta_change_per_gain_percent", term.max_sensitivity}});
    if (term.beta_max) fit["terms"].back()["beta_max"] = *term.beta_max;
  }
  fit["left_out"] = Json::array();
  for (const LeftOutPoint& l : left_out) {
    fit["left_out"].push_back({{"frequency_hz", l.frequency.value},
                               {"miss_db", l.error_db},
                               {"max_change_db", l.max_change_db},
                               {"max_change_hz", l.max_change_at.value}});
  }
  fit["excursions"] = Json::array();
  for (const Excursion& e : excursions) {
    fit["excursions"].push_back({{"from_hz", e.between.from.value},
                                 {"to_hz", e.between.to.value},
                                 {"worst_hz", e.worst.value},
                                 {"outside_db", e.outside_db}});
  }
  Json below = Json::array();
  for (const Hertz f : points_below_base) below.push_back(f.value);
  fit["points_below_base_hz"] = below;
  fit["warnings"] = warnings;
  return out;
}

}  // namespace bodesmith
