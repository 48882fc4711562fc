#pragma once

#include <cstddef>
#include <functional>

namespace bodesmith {

/// work(i) for every i < count on up to `threads` threads (each i once, in rising order of start). After an
/// exception nothing more is started, and the first one is thrown again here. Results must go to places of
/// their own, so the outcome does not depend on the threads.
void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& work);

/// Threads that work begun in this thread may share among parts of its own: as many as the innermost scope of ThreadAllowance
/// says, one where there is none. Within parallel_for's work on several threads one, as all are at work.
int allowed_threads();

/// Allows threads to what is begun in this thread while it lives. For work deep inside that cannot be told of them; like
/// parallel_for it must come to the same on any number.
class ThreadAllowance {
 public:
  explicit ThreadAllowance(int threads);
  ~ThreadAllowance();
  ThreadAllowance(const ThreadAllowance&) = delete;
  ThreadAllowance& operator=(const ThreadAllowance&) = delete;

 private:
  int before_;
};

/// `wanted` threads, or as many as the machine has cores when that is 0 (or less).
int thread_count(int wanted);

}  // namespace bodesmith
