#include "lti/group_delay.hpp"

namespace bodesmith {

double group_delay_s(const Sections& sections, RadPerSecond w) {
  double delay = sections.delay_s;
  const std::complex<double> s(0.0, w.value);
  for (const Section& section : sections.sections) {
    for (const std::complex<double>& p : section.poles) delay += (1.0 / (s - p)).real();
    // A zero on the axis turns the phase at one frequency and nowhere else.
    for (const std::complex<double>& z : section.zeros) {
      if (z.real() != 0.0) delay -= (1.0 / (s - z)).real();
    }
  }
  return delay;
}

double group_delay_s(const std::function<std::complex<double>(Hertz)>& response, Hertz f) {
  constexpr double kStep = 1e-4;
  const std::complex<double> above = response(Hertz{f.value * (1.0 + kStep)});
  const std::complex<double> below = response(Hertz{f.value * (1.0 - kStep)});
  return -std::arg(above / below) / (2.0 * kStep * f.rad_s().value);
}

}  // namespace bodesmith
