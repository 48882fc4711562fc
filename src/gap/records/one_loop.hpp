#pragma once

#include <cstddef>

#include "gap/scene.hpp"

namespace bodesmith::gap {

/// All there is to fit is one record, in which this boundary runs along one loop again and again: what smaller
/// loops look like it cannot tell.
bool is_one_loop(const Scene& scene, std::size_t at);

}  // namespace bodesmith::gap
