#include "base/json.hpp"
#include "project/tracking_study.hpp"
#include "signal/columns.hpp"
#include "signal/csv.hpp"

namespace bodesmith::project {
namespace {

std::vector<double> tracked_hertz(const TrackingStudy& study) {
  std::vector<double> out;
  for (const Hertz f : study.frequency) out.push_back(f.value);
  return out;
}

}  // namespace

Json to_json(const TrackingStudy& study) {
  Json out;
  out["frequency_hz"] = tracked_hertz(study);
  out["designs"] = Json::array();
  for (const TrackedDesign& design : study.designs) {
    out["designs"].push_back({{"key", to_string(design.stage)},
                              {"name", design.name},
                              {"rms_percent", design.rms_percent},
                              {"max_percent", design.max_percent},
                              {"rms_percent_without_lag", design.rms_percent_without_lag},
                              {"lag_s", design.lag_s}});
  }
  out["cross_check_percent"] = study.max_cross_check_percent;
  out["findings"] = study.findings;
  return out;
}

std::string tracking_csv(const TrackingStudy& study) {
  CsvWriter writer;
  writer.add(column::frequency_hz, tracked_hertz(study));
  for (const TrackedDesign& design : study.designs) {
    writer.add(std::string(to_string(design.stage)) + "_percent", design.rms_percent);
  }
  for (const TrackedDesign& design : study.designs) {
    writer.add(std::string(to_string(design.stage)) + "_without_lag_percent", design.rms_percent_without_lag);
  }
  return writer.text();
}

}  // namespace bodesmith::project
