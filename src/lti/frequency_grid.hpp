#pragma once

#include <vector>

#include "base/units.hpp"

namespace bodesmith {

struct Band {
  Hertz from;
  Hertz to;
};

/// `count` frequencies, evenly spaced in log frequency, both ends included. Throws InputError unless
/// 0 < from <= to and count >= 2 (or 1 with from == to).
std::vector<Hertz> log_grid(Band band, int count);

}  // namespace bodesmith
