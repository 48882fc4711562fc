#pragma once

#include <complex>
#include <functional>
#include <span>
#include <vector>

#include "circuit/realise.hpp"

namespace bodesmith::circuit {

/// H of a design at one frequency for given part values.
using ResponseOfValues = std::function<std::complex<double>(Hertz, std::span<const double>)>;

/// d ln H/d ln part by central differences (step 1e-4), scaled to a change of 1 %.
struct Sensitivity {
  std::vector<std::vector<double>> db_per_percent;  ///< [part][frequency]; 0 at a null of the response
  std::vector<std::vector<double>> deg_per_percent;
};
Sensitivity sensitivity_of(const ResponseOfValues& response, std::vector<double> nominal,
                           std::span<const Hertz> grid);

/// H with ideal op-amps for any part values, as the product of the stages' transfers. Throws std::logic_error
/// for a circuit whose stages have no equations (ladders).
std::complex<double> stages_response(const Circuit& circuit, Hertz f, std::span<const double> values);

/// Greatest change of the magnitude over the report's band, dB for 1 % of each part.
std::vector<double> worst_db_per_percent(const Realised& realised);

}  // namespace bodesmith::circuit
