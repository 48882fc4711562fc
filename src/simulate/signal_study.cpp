#include "simulate/signal_study.hpp"

#include <algorithm>
#include <stdexcept>

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

}  // namespace bodesmith::simulate
