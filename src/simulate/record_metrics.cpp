#include "simulate/record_metrics.hpp"

#include <stdexcept>

#include "signal/error_figures.hpp"

namespace bodesmith::simulate {

RecordDifference compare_records(std::span<const double> simulated, std::span<const double> measured) {
  if (simulated.size() != measured.size() || measured.empty())
    throw std::logic_error("records of different length were compared");
  const ErrorFigures figures = error_figures(simulated, measured);
  return {figures.rms, figures.max, figures.rms_percent};
}

}  // namespace bodesmith::simulate
