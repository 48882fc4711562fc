#pragma once

namespace bodesmith {

// The SI's own (2019), exact.
inline constexpr double kBoltzmann = 1.380649e-23;    ///< J/K
inline constexpr double kElectron = 1.602176634e-19;  ///< C

}  // namespace bodesmith
