#include "simulate/signal_study.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "base/documents/json.hpp"
#include "base/whole_number.hpp"
#include "signal/columns.hpp"
#include "signal/csv.hpp"

namespace bodesmith::simulate {
namespace {

/// What y was at the crossings of one level in one direction.
struct Crossings {
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();
  void add(double y) {
    min = std::min(min, y);
    max = std::max(max, y);
  }
  bool any() const { return max >= min; }
};

/// Cycles of the fundamental in one repetition of u: 60 Hz at 4 kHz repeats after 200 samples and 3 cycles. The
/// strongest line, when the lines near its multiples are below a hundredth of it (sampling folds the high harmonics of
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

Loop hysteresis_loop(std::span<const double> u, std::span<const double> y) {
  constexpr std::size_t levels = 101;
  if (u.size() != y.size()) throw std::logic_error("a loop needs one output for each input");
  Loop loop;
  if (u.size() < 3) return loop;
  const auto [low, high] = std::minmax_element(u.begin(), u.end());
  if (!(*high > *low)) return loop;
  const double gap = (*high - *low) / static_cast<double>(levels + 1);
  const auto level = [&, from = *low](std::size_t i) { return from + gap * static_cast<double>(i + 1); };
  std::vector<Crossings> rising(levels);
  std::vector<Crossings> falling(rising.size());
  for (std::size_t k = 1; k < u.size(); ++k) {
    const double from = std::min(u[k - 1], u[k]);
    const double to = std::max(u[k - 1], u[k]);
    const bool up = u[k] > u[k - 1];
    // A level that is met exactly counts where it is left towards, so that it is counted once.
    auto i = whole_number<std::size_t>(std::floor((from - *low) / gap) - 1.0);
    for (; i < levels && level(i) <= to; ++i) {
      const bool crossed = up ? u[k - 1] < level(i) : u[k - 1] > level(i) && u[k] <= level(i);
      if (!crossed) continue;
      const double at = y[k - 1] + (y[k] - y[k - 1]) * (level(i) - u[k - 1]) / (u[k] - u[k - 1]);
      (up ? rising : falling)[i].add(at);
    }
  }
  for (std::size_t i = 0; i < levels; ++i) {
    const Crossings& up = rising[i];
    const Crossings& down = falling[i];
    if (!up.any() || !down.any()) continue;
    const bool below = down.max - up.min >= up.max - down.min;  // the rising branch runs below
    loop.u.push_back(level(i));
    loop.ascending.push_back(below ? up.min : up.max);
    loop.descending.push_back(below ? down.max : down.min);
    loop.height = std::max(loop.height, std::abs(loop.ascending.back() - loop.descending.back()));
  }
  const auto [y_low, y_high] = std::minmax_element(y.begin(), y.end());
  if (*y_high > *y_low) loop.height_percent = 100.0 * loop.height / (*y_high - *y_low);
  return loop;
}

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
  Json out = {{"periodic", study.repetition.has_value()}, {"resolution_hz", study.u.frequency[1].value}};
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
