#include "simulate/signal_study.hpp"

#include <algorithm>
#include <stdexcept>

#include "base/json.hpp"
#include "signal/columns.hpp"
#include "signal/csv.hpp"

namespace bodesmith::simulate {
namespace {

/// Cycles of the fundamental in one repetition of u: 60 Hz at 4 kHz repeats after 200 samples and 3 cycles. The
/// strongest line, when the lines beside its multiples are below a hundredth of it (sampling folds the high harmonics of
/// a kinked signal between them); else 1.
std::size_t cycles_of(const Spectrum& u) {
  if (u.amplitude.size() < 3) return 1;
  const auto begin = u.amplitude.begin() + 1;  // no constant
  const auto strongest = std::max_element(begin, u.amplitude.end());
  const auto line = static_cast<std::size_t>(strongest - u.amplitude.begin());
  for (std::size_t k = 1; k < u.amplitude.size(); ++k) {
    if (k % line != 0 && u.amplitude[k] > 0.01 * *strongest) return 1;
  }
  return line;
}

}  // namespace

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
    if (!fundamental)
      out.repetition->cycles = cycles_of(spectrum_of(u.subspan(from, count), start_s, step_s, true));
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
