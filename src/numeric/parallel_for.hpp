#pragma once

#include <cstddef>
#include <functional>

namespace bodesmith {

/// work(i) for every i < count on up to `threads` threads (each i once, in rising order of start). After an
/// exception nothing more is started, and the first one is thrown again here. Results must go to places of
/// their own, so the outcome does not depend on the threads.
void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& work);

/// `wanted` threads, or as many as the machine has cores when that is 0 (or less).
int thread_count(int wanted);

}  // namespace bodesmith
