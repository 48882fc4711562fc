#pragma once

#include "report/plot.hpp"

namespace bodesmith::report {

/// Magnitude (dB) and phase (degrees) over log frequency, one below the other; the caller adds the series.
struct BodePlot {
  Plot magnitude;
  Plot phase;
  BodePlot();
  std::vector<Plot> plots() const { return {magnitude, phase}; }
};

}  // namespace bodesmith::report
