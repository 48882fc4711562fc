#pragma once

#include <cstddef>

#include "report/plot.hpp"

namespace bodesmith::report {

/// A series of at most about 1.5 times `most` points in the order of the given one: of every stretch the lowest and the highest,
/// so that peaks survive, and a gap where the stretch has one. Stretches are equally wide along x as it is drawn (`logarithmic`:
/// per decade, samples without a place there are left out); of a series whose x goes back and forth, equally long. Series of at most
/// `most` points stay as they are.
Series thinned(Series series, std::size_t most, bool logarithmic = false);

}  // namespace bodesmith::report
