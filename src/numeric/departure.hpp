#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "numeric/random.hpp"

/// What drawn copies have in common, whatever is made of them: numbers of their own.
namespace bodesmith {

/// How far one quantity of a built copy may be off.
struct Departure {
  enum class Law {
    uniform,  ///< evenly within +-scale
    normal,   ///< standard deviation `scale`, cut at `cut` of them
    corners,  ///< one of the two limits +-scale
  };
  Law law = Law::uniform;
  double scale = 0.0;
  double cut = std::numeric_limits<double>::infinity();

  double deviation() const {
    return law == Law::uniform ? scale / std::sqrt(3.0) : scale;
  }                                                                          ///< standard, before the cut
  double limit() const { return law == Law::normal ? scale * cut : scale; }  ///< greatest |value|

  /// Of u, uniform in (0, 1).
  double drawn(double u) const {
    switch (law) {
      case Law::uniform:
        return scale * (2.0 * u - 1.0);
      case Law::normal:
        return scale * std::clamp(normal_quantile(u), -cut, cut);
      case Law::corners:
        return u < 0.5 ? -scale : scale;
    }
    return 0.0;
  }
};

/// Copy number `copy`: place i of `count` takes u, uniform in (0, 1), a function of seed, copy and place, whichever thread or
/// process draws it (numeric/random.hpp). `series` tells independent sets of numbers of one copy apart.
template <class Take>
void for_each_drawn(std::uint64_t seed, std::uint64_t copy, std::size_t count, const Take& take,
                    std::uint32_t series = 0) {
  for (std::size_t i = 0; i < count; i += 2) {
    const auto u = uniform_pair(seed, copy, series + static_cast<std::uint32_t>(i / 2));
    for (std::size_t k = 0; k < 2 && i + k < count; ++k) take(i + k, u[k]);
  }
}

}  // namespace bodesmith
