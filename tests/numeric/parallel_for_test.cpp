#include "numeric/parallel_for.hpp"

#include <gtest/gtest.h>

#include <vector>

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

TEST(AllowedThreads, AreOneWhereAllAreAtWorkAlready) {
  const ThreadAllowance three(3);
  std::vector<int> seen(16, 0);
  parallel_for(seen.size(), 2, [&](std::size_t i) { seen[i] = allowed_threads(); });
  EXPECT_EQ(seen, std::vector<int>(16, 1));
  EXPECT_EQ(allowed_threads(), 3);
}

TEST(AllowedThreads, StayForTheOnlyPieceOfWork) {
  const ThreadAllowance three(3);
  int seen = 0;
  parallel_for(1, 3, [&](std::size_t) { seen = allowed_threads(); });
  EXPECT_EQ(seen, 3);
}

}  // namespace
}  // namespace bodesmith
