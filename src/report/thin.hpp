#pragma once

#include <cstddef>

#include "report/plot.hpp"

namespace bodesmith::report {

/// A series of at most about `most` points in the order of the given one: of every stretch of samples the lowest and the
/// highest, so that peaks survive, and a gap where the stretch has one. Shorter series stay as they are.
Series thinned(Series series, std::size_t most);

}  // namespace bodesmith::report
