#include "numeric/parallel_for.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace bodesmith {
namespace {

thread_local int allowance = 1;

}  // namespace

int allowed_threads() {
  return allowance;
}

ThreadAllowance::ThreadAllowance(int threads) : before_(allowance) {
  allowance = threads;
}
ThreadAllowance::~ThreadAllowance() {
  allowance = before_;
}

void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex guard;
  const auto loop = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      try {
        work(i);
      } catch (...) {
        const std::lock_guard lock(guard);
        if (!failure) failure = std::current_exception();
        next = count;
      }
    }
  };
  std::vector<std::thread> helpers;
  const std::size_t team = std::min(count, static_cast<std::size_t>(std::max(threads, 1)));
  try {
    for (std::size_t t = 1; t < team; ++t) helpers.emplace_back(loop);
  } catch (const std::system_error&) {
    // No more threads are to be had: those that there are do the work.
  }
  {
    const ThreadAllowance busy(helpers.empty() ? allowance : 1);
    loop();
  }
  for (auto& h : helpers) h.join();
  if (failure) std::rethrow_exception(failure);
}

int thread_count(int wanted) {
  return wanted > 0 ? wanted : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

}  // namespace bodesmith
