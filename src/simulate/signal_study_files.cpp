#include "simulate/signal_study_files.hpp"

#include <algorithm>

#include "base/json.hpp"
#include "signal/columns.hpp"
#include "signal/csv.hpp"

namespace bodesmith::simulate {

std::string spectra_csv(const SignalStudy& study, const std::string& input) {
  CsvWriter csv;
  std::vector<double> hertz;
  std::vector<double> harmonic;
  for (std::size_t k = 0; k < study.u.frequency.size(); ++k) {
    hertz.push_back(study.u.frequency[k].value);
    if (study.repetition)
      harmonic.push_back(static_cast<double>(k) / static_cast<double>(study.repetition->cycles));
  }
  csv.add(column::frequency_hz, std::move(hertz));
  if (study.repetition) csv.add("harmonic", std::move(harmonic));
  csv.add(input + "_amplitude", study.u.amplitude);
  csv.add(input + "_phase_deg", study.u.phase_deg);
  csv.add("y_amplitude", study.y.amplitude);
  csv.add("y_phase_deg", study.y.phase_deg);
  return csv.text();
}

std::string loops_csv(const SignalStudy& study, const std::string& input) {
  std::vector<double> period, level, ascending, descending, height;
  for (std::size_t i = 0; i < study.loops.size(); ++i) {
    const Loop& loop = study.loops[i];
    period.insert(period.end(), loop.u.size(), static_cast<double>(i + 1));
    level.insert(level.end(), loop.u.begin(), loop.u.end());
    ascending.insert(ascending.end(), loop.ascending.begin(), loop.ascending.end());
    descending.insert(descending.end(), loop.descending.begin(), loop.descending.end());
    height.insert(height.end(), loop.u.size(), loop.height_percent);
  }
  CsvWriter csv;
  csv.add("period", std::move(period));
  csv.add(input, std::move(level));
  csv.add("ascending", std::move(ascending));
  csv.add("descending", std::move(descending));
  csv.add("height_percent", std::move(height));
  return csv.text();
}

Json spectra_json(const SignalStudy& study, const std::string& input) {
  Json out;
  out["periodic"] = study.repetition.has_value();
  out["resolution_hz"] = study.u.frequency[1].value;
  if (!study.repetition) return out;
  out["fundamental_hz"] = study.fundamental->value;
  out["thd_percent"] = Json::object();
  if (study.u_distortion_percent) out["thd_percent"][input] = *study.u_distortion_percent;
  if (study.y_distortion_percent) out["thd_percent"]["y"] = *study.y_distortion_percent;
  out["harmonics"] = Json::array();
  for (std::size_t k = 1; k <= 10 && k * study.repetition->cycles < study.u.frequency.size(); ++k) {
    const std::size_t at = k * study.repetition->cycles;
    out["harmonics"].push_back({{"harmonic", k},
                                {"frequency_hz", study.u.frequency[at].value},
                                {input + "_amplitude", study.u.amplitude[at]},
                                {input + "_phase_deg", study.u.phase_deg[at]},
                                {"y_amplitude", study.y.amplitude[at]},
                                {"y_phase_deg", study.y.phase_deg[at]}});
  }
  return out;
}

Json loops_json(const SignalStudy& study) {
  double max_height = 0.0;
  for (const Loop& loop : study.loops) max_height = std::max(max_height, loop.height_percent);
  return {{"periods", study.loops.size()},
          {"height", study.loops.back().height},
          {"height_percent", study.loops.back().height_percent},
          {"largest_height_percent", max_height}};
}

}  // namespace bodesmith::simulate
