#include "circuit/opamp.hpp"

namespace bodesmith {

std::complex<double> OpAmpModel::open_loop(RadPerSecond w) const {
  return dc_gain / std::complex<double>(1.0, w.value * dc_gain / gain_bandwidth.rad_s().value);
}

}  // namespace bodesmith
