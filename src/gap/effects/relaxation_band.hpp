#pragma once

#include "gap/scene.hpp"

namespace bodesmith::gap {

// Logarithmic creep of time constants t1 to t2 and a fractional lead-lag of those corners leave the same traces to the
// first order of their size:
//     1 + g - g ln((1 + s t2)/(1 + s t1)) / ln(t2/t1)   and   ((1 + s t2)/(1 + s t1))^beta,   beta = -g / ln(t2/t1).
// What tells them apart is where they lie: creep goes on long after the drive has moved, rate dependence changes the
// gain within the band that is driven. Between the two limits either is as good a name. Of time records alone.

/// A middle time constant, s, that belongs to a change of gain within the driven band.
bool lies_in_driven_band(double middle_s, const Scene& scene);
/// One that belongs to something slower than that.
bool lies_below_driven_band(double middle_s, const Scene& scene);

}  // namespace bodesmith::gap
