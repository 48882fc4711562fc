#include <fmt/format.h>

#include "base/json.hpp"
#include "project/tracking_study.hpp"
#include "signal/csv.hpp"

namespace bodesmith::project {

const TrackedDesign* TrackingStudy::find(const std::string& key) const {
  for (const TrackedDesign& design : designs) {
    if (design.key == key) return &design;
  }
  return nullptr;
}

Json TrackingStudy::to_json() const {
  Json out;
  std::vector<double> hertz;
  for (const Hertz f : frequency) hertz.push_back(f.value);
  out["frequency_hz"] = hertz;
  out["designs"] = Json::array();
  for (const TrackedDesign& design : designs) {
    out["designs"].push_back({{"key", design.key},
                              {"name", design.name},
                              {"rms_percent", design.rms_percent},
                              {"max_percent", design.max_percent},
                              {"rms_percent_without_lag", design.rms_percent_without_lag},
                              {"lag_s", design.lag_s}});
  }
  out["cross_check_percent"] = largest_cross_check_percent;
  out["findings"] = findings;
  return out;
}

std::string TrackingStudy::csv() const {
  CsvWriter writer;
  std::vector<double> hertz;
  for (const Hertz f : frequency) hertz.push_back(f.value);
  writer.add("frequency_hz", hertz);
  for (const TrackedDesign& design : designs) writer.add(design.key + "_percent", design.rms_percent);
  for (const TrackedDesign& design : designs)
    writer.add(design.key + "_without_lag_percent", design.rms_percent_without_lag);
  return writer.text();
}

}  // namespace bodesmith::project
