#include "numeric/termination.hpp"

#include <gtest/gtest.h>

namespace bodesmith {
namespace {

TEST(Termination, OnlyAMinimumCountsAsConverged) {
  EXPECT_TRUE(converged(Termination::gradient));
  EXPECT_TRUE(converged(Termination::step));
  EXPECT_TRUE(converged(Termination::cost));
  EXPECT_FALSE(converged(Termination::max_iterations));
  EXPECT_FALSE(converged(Termination::stopped));
  EXPECT_FALSE(converged(Termination::not_runnable));
}

}  // namespace
}  // namespace bodesmith
