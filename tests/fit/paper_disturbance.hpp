#pragma once

#include "signal/disturbance.hpp"

namespace bodesmith {

/// The disturbance paper's polynomials, its rate gains on both branches.
inline Disturbance both_driven() {
  Disturbance out;
  out.ascending = {0.3546, -0.6433, 0.2887};
  out.descending = {-0.2398, 0.0838, 0.156};
  for (const double f : {1.0, 10.0, 20.0, 60.0, 100.0}) out.rate.frequency.push_back(Hertz{f});
  out.rate.descending = {1, 1.06, 1.1, 1.04, 1.17};
  out.rate.ascending = out.rate.descending;
  return out;
}

}  // namespace bodesmith
