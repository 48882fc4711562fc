#include "simulate/signal_study.hpp"

#include <algorithm>
#include <stdexcept>

#include "base/json.hpp"
#include "signal/csv.hpp"

namespace bodesmith::simulate {

SignalStudy study_signals(std::span<const double> u, std::span<const double> y, double start_s, double step_s,
                          std::optional<Hertz> fundamental) {
  if (u.size() != y.size() || u.size() < 2) throw std::logic_error("a study needs two signals of one length");
  SignalStudy out;
  out.repetition = fundamental ? repetition_of(*fundamental, step_s, u.size()) : find_repetition(u);
  std::size_t from = 0;
  std::size_t count = u.size();
  if (out.repetition) {
    count = out.repetition->samples;
    from = u.size() > count ? u.size() - 1 - count : 0;
    out.fundamental =
        Hertz{static_cast<double>(out.repetition->cycles) / (step_s * static_cast<double>(count))};
  }
  const double begin_s = start_s + step_s * static_cast<double>(from);
  out.u = spectrum_of(u.subspan(from, count), begin_s, step_s, out.repetition.has_value());
  out.y = spectrum_of(y.subspan(from, count), begin_s, step_s, out.repetition.has_value());
  if (!out.repetition) {
    out.loops.push_back(hysteresis_loop(u, y));
    return out;
  }
  out.u_distortion_percent = distortion_percent(out.u, out.repetition->cycles);
  out.y_distortion_percent = distortion_percent(out.y, out.repetition->cycles);
  // A loop closes with the first sample of the next period.
  for (std::size_t at = 0; at + count < u.size(); at += count) {
    out.loops.push_back(hysteresis_loop(u.subspan(at, count + 1), y.subspan(at, count + 1)));
  }
  if (out.loops.empty()) out.loops.push_back(hysteresis_loop(u, y));
  return out;
}

std::string SignalStudy::spectra_csv(const std::string& input) const {
  CsvWriter csv;
  std::vector<double> hertz;
  std::vector<double> harmonic;
  for (std::size_t k = 0; k < u.frequency.size(); ++k) {
    hertz.push_back(u.frequency[k].value);
    if (repetition) harmonic.push_back(static_cast<double>(k) / static_cast<double>(repetition->cycles));
  }
  csv.add("frequency_hz", std::move(hertz));
  if (repetition) csv.add("harmonic", std::move(harmonic));
  csv.add(input + "_amplitude", u.amplitude);
  csv.add(input + "_phase_deg", u.phase_deg);
  csv.add("y_amplitude", y.amplitude);
  csv.add("y_phase_deg", y.phase_deg);
  return csv.text();
}

std::string SignalStudy::loops_csv(const std::string& input) const {
  std::vector<double> period, level, ascending, descending, height;
  for (std::size_t i = 0; i < loops.size(); ++i) {
    const Loop& loop = loops[i];
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

Json SignalStudy::spectra_json(const std::string& input) const {
  Json out;
  out["periodic"] = repetition.has_value();
  out["resolution_hz"] = u.frequency[1].value;
  if (!repetition) return out;
  out["fundamental_hz"] = fundamental->value;
  out["thd_percent"] = Json::object();
  if (u_distortion_percent) out["thd_percent"][input] = *u_distortion_percent;
  if (y_distortion_percent) out["thd_percent"]["y"] = *y_distortion_percent;
  out["harmonics"] = Json::array();
  for (std::size_t k = 1; k <= 10 && k * repetition->cycles < u.frequency.size(); ++k) {
    const std::size_t at = k * repetition->cycles;
    out["harmonics"].push_back({{"harmonic", k},
                                {"frequency_hz", u.frequency[at].value},
                                {input + "_amplitude", u.amplitude[at]},
                                {input + "_phase_deg", u.phase_deg[at]},
                                {"y_amplitude", y.amplitude[at]},
                                {"y_phase_deg", y.phase_deg[at]}});
  }
  return out;
}

Json SignalStudy::loops_json() const {
  double largest = 0.0;
  for (const Loop& loop : loops) largest = std::max(largest, loop.height_percent);
  return {{"periods", loops.size()},
          {"height", loops.back().height},
          {"height_percent", loops.back().height_percent},
          {"largest_height_percent", largest}};
}

}  // namespace bodesmith::simulate
