#include "numeric/parallel_for.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

#include "base/error.hpp"

namespace bodesmith {
namespace {

TEST(AllowedThreads, AreThoseOfTheInnermostScope) {
  EXPECT_EQ(allowed_threads(), 1);
  {
    const ThreadAllowance three(3);
    EXPECT_EQ(allowed_threads(), 3);
    {
      const ThreadAllowance five(5);
      EXPECT_EQ(allowed_threads(), 5);
    }
    EXPECT_EQ(allowed_threads(), 3);
  }
  EXPECT_EQ(allowed_threads(), 1);
}

// One piece of work is there and then gone; the thread that did it joins the other, which goes on until it is seen there.
TEST(ParallelFor, ThreadsThatAreFreeJoinWorkWithinOtherWork) {
  std::set<std::thread::id> seen;
  std::mutex guard;
  parallel_for(2, 2, [&](std::size_t outer) {
    EXPECT_EQ(allowed_threads(), 2);
    while (outer == 1 && seen.size() < 2) {
      parallel_for(2, allowed_threads(), [&](std::size_t) {
        const std::lock_guard lock(guard);
        seen.insert(std::this_thread::get_id());
      });
    }
  });
  EXPECT_EQ(seen.size(), 2u);
  EXPECT_EQ(allowed_threads(), 1);
}

TEST(ParallelFor, WorkWithinWorkIsDoneOnceWhereverItFails) {
  for (const int threads : {1, 2, 7}) {
    std::vector<std::atomic<int>> done(40 * 30);
    const ThreadAllowance some(threads);
    parallel_for(40, threads, [&](std::size_t i) {
      parallel_for(30, threads, [&](std::size_t k) { ++done[30 * i + k]; });
    });
    for (const auto& one : done) EXPECT_EQ(one, 1);
    std::atomic<int> begun{0};
    EXPECT_THROW(parallel_for(40, threads,
                              [&](std::size_t i) {
                                parallel_for(30, threads, [&](std::size_t) {
                                  ++begun;
                                  if (i == 3) throw InputError("this one");
                                });
                              }),
                 InputError);
    EXPECT_LT(begun, 40 * 30);
    EXPECT_EQ(allowed_threads(), threads);
  }
}

TEST(ParallelFor, OneThreadIsOne) {
  const ThreadAllowance one(1);
  parallel_for(50, 8, [me = std::this_thread::get_id()](std::size_t) {
    parallel_for(3, 8, [me](std::size_t) { EXPECT_EQ(std::this_thread::get_id(), me); });
  });
}

TEST(AllowedThreads, StayForTheOnlyPieceOfWork) {
  const ThreadAllowance three(3);
  int seen = 0;
  parallel_for(1, 3, [&](std::size_t) { seen = allowed_threads(); });
  EXPECT_EQ(seen, 3);
}

}  // namespace
}  // namespace bodesmith
