#include "base/json.hpp"
#include "fit/waveform_fit.hpp"

namespace bodesmith {
namespace {

Json error_json(const WaveformError& error) {
  Json points = Json::array();
  for (const WaveformErrorPoint& point : error.points) {
    points.push_back({{"frequency_hz", point.frequency.value},
                      {"rms_percent", point.rms_percent},
                      {"peak_percent", point.peak_percent}});
  }
  return {{"rms_percent", error.rms_percent}, {"worst_percent", error.worst_percent}, {"points", points}};
}

}  // namespace

Json WaveformFit::report_json() const {
  Json out;
  out["error"] = error_json(error);
  out["between"] = error_json(between);
  out["between_none"] = error_json(between_none);
  out["no_compensation"] = error_json(none);
  if (!magnitude_only.points.empty()) out["magnitude_only"] = error_json(magnitude_only);
  out["constant_gain"] = constant_gain;
  out["constant"] = error_json(constant);
  out["lower_bound_percent"] = lower_bound_percent;
  out["starts_tried"] = starts_tried;
  out["warnings"] = warnings;
  return out;
}

}  // namespace bodesmith
