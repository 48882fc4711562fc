#include "base/json.hpp"
#include "fit/direct_fit.hpp"

namespace bodesmith {

Json DirectFit::report_json() const {
  Json out;
  out["points"] = Json::array();
  for (const DirectFitPoint& point : points) {
    out["points"].push_back(
        {{"frequency_hz", point.frequency.value}, {"wanted_db", point.wanted_db}, {"got_db", point.got_db}});
  }
  out["rms_db"] = rms_db;
  out["max_db"] = max_db;
  out["mask_violation_db"] = mask_violation_db;
  out["highest_gain_above_band_db"] = highest_gain_above_band_db;
  out["parameters"] = parameters;
  out["starts_tried"] = starts_tried;
  out["cancelled_poles"] = cancelled;
  out["distant_zeros"] = distant_zeros;
  out["warnings"] = warnings;
  out["not_tried"] = not_tried;
  return out;
}

}  // namespace bodesmith
