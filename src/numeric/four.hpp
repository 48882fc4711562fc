#pragma once

namespace bodesmith {

/// Four numbers side by side, wherever they lie: one instruction on processors with wide vectors, two on others, the same bits.
using Four __attribute__((vector_size(32), aligned(8), may_alias)) = double;

inline const Four* four_at(const double* from) {
  return reinterpret_cast<const Four*>(from);
}
inline Four* four_at(double* to) {
  return reinterpret_cast<Four*>(to);
}

}  // namespace bodesmith
