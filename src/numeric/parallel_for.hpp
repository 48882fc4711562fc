#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace bodesmith {

/// work(i) for every i < count on up to `threads` threads (each i once, in rising order of start). After an
/// exception nothing more is started, and the first one is thrown again here. Results must go to places of
/// their own, so the outcome does not depend on the threads. Within other work on several threads, or a ThreadAllowance, it is
/// joined only by threads that these have free, as soon as they are.
void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& work);

/// Threads that work begun in this thread may share with all that is at work there: those of the innermost ThreadAllowance or
/// parallel_for around, one where there is none.
int allowed_threads();

/// Threads that are free to join; one is given back when it finds nothing more to do, or waits.
struct FreeThreads {
  explicit FreeThreads(int threads) : all(std::max(threads, 1)), free(all - 1) {}
  const int all;
  std::atomic<int> free;
};

/// Allows threads to what is begun in this thread while it lives. For work deep inside that cannot be told of them; like
/// parallel_for it must come to the same on any number.
class ThreadAllowance {
 public:
  explicit ThreadAllowance(int threads);
  ~ThreadAllowance();
  ThreadAllowance(const ThreadAllowance&) = delete;
  ThreadAllowance& operator=(const ThreadAllowance&) = delete;

 private:
  FreeThreads threads_;
  FreeThreads* before_;
};

/// `wanted` threads, or as many as the machine has cores when that is 0 (or less).
int thread_count(int wanted);

/// The processes that share one job: alone, or under `mpirun -n N`.
class Team {
 public:
  virtual ~Team() = default;
  virtual int rank() const { return 0; }
  virtual int size() const { return 1; }
  bool leads() const { return rank() == 0; }
  /// Sums, minima and maxima of all processes; the result is the leader's only.
  virtual void sum(std::vector<std::uint64_t>&) const {}
  virtual void min(std::vector<double>&) const {}
  virtual void max(std::vector<double>&) const {}
  /// The leader's value, for everyone.
  virtual std::uint64_t from_leader(std::uint64_t value) const { return value; }
};

/// Joins the MPI job when the program was started by mpirun and MPI support was built (a module next to the
/// program, loaded only then: a program started alone pays nothing for it); otherwise a team of one. Throws
/// InputError when started by mpirun without MPI support. Leaves the job when destroyed.
std::unique_ptr<Team> join_team();

}  // namespace bodesmith
