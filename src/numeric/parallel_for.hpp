#pragma once

#include <cstddef>
#include <functional>

namespace bodesmith {

/// work(i) for every i < count on `threads` threads (each i once, in rising order of start). After
/// the first exception no more are started, and it is thrown again here. Results must go to places of their
/// own, so the outcome does not depend on the threads.
void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& work);

}  // namespace bodesmith
