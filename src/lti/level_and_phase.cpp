#include "lti/level_and_phase.hpp"

#include <cmath>
#include <numbers>

#include "base/units.hpp"
#include "lti/bulk_response.hpp"
#include "numeric/clones.hpp"
#include "numeric/log_and_angle.hpp"

namespace bodesmith {
namespace {

constexpr double kDecibelPerLog = 10.0 / std::numbers::ln10;  // of a square
constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

BODESMITH_CLONES void levels_and_angles(const std::complex<double>* response, double* level_db,
                                        double* angle_deg, std::size_t count) {
  const auto* parts =
      reinterpret_cast<const double*>(response);  // [complex.numbers.general]: re, im, re, ...
  for (std::size_t i = 0; i < count; ++i) {
    const double re = parts[2 * i];
    const double im = parts[2 * i + 1];
    level_db[i] = kDecibelPerLog * log_of(re * re + im * im);
    angle_deg[i] = kDegreesPerRadian * angle_of(re, im);
  }
}

/// One piece, the turns not yet followed.
void put(std::span<const std::complex<double>> response, std::size_t begin, LevelAndPhase& out) {
  levels_and_angles(response.data(), &out.magnitude_db[begin], &out.phase_deg[begin], response.size());
  for (std::size_t i = 0; i < response.size(); ++i) {
    // The square of a gain may leave the range of a double where the gain does not.
    constexpr double kSafeDb = 2900.0;
    double& level = out.magnitude_db[begin + i];
    if (std::abs(level) < kSafeDb) continue;
    level = to_decibel(std::abs(response[i]));
    out.phase_deg[begin + i] = to_degrees(std::arg(response[i]));
  }
}

LevelAndPhase of_length(std::size_t n) {
  LevelAndPhase out;
  out.magnitude_db.resize(n);
  out.phase_deg.resize(n);
  return out;
}

void follow_turns(std::vector<double>& phase_deg) {
  double turns = 0.0;
  for (std::size_t i = 1; i < phase_deg.size(); ++i) {
    const double step = phase_deg[i] + turns - phase_deg[i - 1];
    if (std::abs(step) > 180.0) turns -= 360.0 * std::round(step / 360.0);
    phase_deg[i] += turns;
  }
}

}  // namespace

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

LevelAndPhase level_and_phase(std::span<const std::complex<double>> response) {
  LevelAndPhase out = of_length(response.size());
  if (!response.empty()) put(response, 0, out);
  follow_turns(out.phase_deg);
  return out;
}

LevelAndPhase level_and_phase(const Sections& sections, const std::vector<Hertz>& grid) {
  LevelAndPhase out = of_length(grid.size());
  for_pieces(sections, grid,
             [&out](std::size_t begin, std::span<const std::complex<double>> h) { put(h, begin, out); });
  follow_turns(out.phase_deg);
  return out;
}

}  // namespace bodesmith
