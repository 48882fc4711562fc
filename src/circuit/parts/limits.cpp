#include "circuit/parts/limits.hpp"

#include "base/error.hpp"

namespace bodesmith::circuit {

void PartLimits::validate() const {
  if (!(min_ohm > 0.0) || !(max_ohm >= min_ohm)) {
    throw InputError("the limits of the resistors are empty, expected 0 < min <= max");
  }
  if (!(min_f > 0.0) || !(max_f >= min_f)) {
    throw InputError("the limits of the capacitors are empty, expected 0 < min <= max");
  }
}

}  // namespace bodesmith::circuit
