#pragma once

#include <string>

#include "report/plot.hpp"

namespace bodesmith::report {

/// Magnitude (dB) and phase (degrees) over log frequency, one below the other; the caller adds the series.
struct BodePlot {
  Plot magnitude;
  Plot phase;
  BodePlot();
  std::string svg() const { return stack_svg({magnitude, phase}); }
};

}  // namespace bodesmith::report
