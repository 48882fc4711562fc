#pragma once

#include <cmath>
#include <complex>
#include <vector>

#include "faults/measurement.hpp"
#include "lti/frequency_grid.hpp"
#include "numeric/random.hpp"
#include "synthesis/realise.hpp"

namespace bodesmith::faults {

/// Two lead-lags and a damped pair: stages of one and of two op-amps.
inline synthesis::Circuit small_circuit() {
  Sections sections;
  sections.gain = 1.0;
  for (const auto& [zero, pole] : {std::pair(-2000.0, -8000.0), std::pair(-30000.0, -9000.0)}) {
    Section one;
    one.gain = 1.0;
    one.zeros = {zero};
    one.poles = {pole};
    sections.sections.push_back(one);
  }
  Section pair;
  pair.gain = 4e8;
  pair.poles = {{-8000.0, 18000.0}, {-8000.0, -18000.0}};
  sections.sections.push_back(pair);
  return synthesis::realise(sections, {}).circuit;
}

inline std::vector<Hertz> small_grid(int count = 24) {
  return log_grid({Hertz{30.0}, Hertz{60e3}}, count);
}

/// What an instrument with noise and a floor would show of a response.
inline Channel seen(const std::vector<Hertz>& grid, const std::vector<std::complex<double>>& response,
                    std::uint64_t seed, bool with_phase = true, double noise = 2e-3) {
  Random random(seed);
  Channel out;
  out.file = "measured.csv";
  out.grid = grid;
  out.measured_points = grid.size();
  for (const std::complex<double>& h : response) {
    const std::complex<double> shown = h + 1e-5 * std::complex<double>(random.normal(), random.normal());
    out.log_gain.push_back(std::log(std::abs(shown)) + noise * random.normal());
    if (with_phase) out.phase_rad.push_back(std::arg(shown) + noise * random.normal());
  }
  return out;
}

/// A circuit whose parts are within a tolerance of 1 %.
inline synthesis::Circuit drawn_parts(synthesis::Circuit circuit, std::uint64_t seed) {
  Random random(seed);
  for (schematic::Part& part : circuit.parts) part.realised *= 1.0 + 0.01 * (2.0 * random.uniform() - 1.0);
  return circuit;
}

}  // namespace bodesmith::faults
