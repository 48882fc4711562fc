#include "fpaa/device/exchanged_units.hpp"

#include <algorithm>

namespace bodesmith::fpaa {

const char* to_string(UnitArray array) {
  return array == UnitArray::nested ? "nested" : "binary";
}

ExchangedUnits exchanged_units(int from, int to, UnitArray array, double unit_variance) {
  if (from == to || from <= 0 || to <= 0) return {};
  const double shared = array == UnitArray::nested ? std::min(from, to) : from & to;
  const double n = from;
  return {shared / n, unit_variance * (shared * (n - shared) / n + (to - shared))};
}

}  // namespace bodesmith::fpaa
