#pragma once

namespace bodesmith::simulate {

/// Two doubles that are worked on at once, as every x86-64 and ARMv8 can: a vector type of GCC and Clang.
using TwoLanes = double __attribute__((vector_size(16)));

inline TwoLanes load_lanes(const double* p) {
  return TwoLanes{p[0], p[1]};
}
inline TwoLanes both_lanes(double v) {
  return TwoLanes{v, v};
}
inline TwoLanes swapped_lanes(TwoLanes v) {
  return TwoLanes{v[1], v[0]};
}

}  // namespace bodesmith::simulate
