#include "numeric/termination.hpp"

#include <gtest/gtest.h>

#include <set>

namespace bodesmith {
namespace {

TEST(Termination, EveryEndHasItsOwnText) {
  std::set<std::string_view> texts;
  for (const auto end : {Termination::gradient, Termination::step, Termination::cost,
                         Termination::max_iterations, Termination::stopped, Termination::not_runnable}) {
    texts.insert(to_string(end));
  }
  EXPECT_EQ(texts.size(), 6U);
  EXPECT_EQ(to_string(Termination::max_iterations), "max_iterations");
}

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
