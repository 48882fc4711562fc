#include "project/stages.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <string>

namespace bodesmith::project {
namespace {

TEST(Stages, BeginWhenWhatTheyNeedIsDone) {
  // Sums along a lattice: each place needs its left and its upper neighbour, the corner is a binomial coefficient.
  constexpr std::size_t kSize = 5;
  long paths[kSize][kSize] = {};
  Stages stages;
  for (std::size_t i = 0; i < kSize; ++i) {
    for (std::size_t j = 0; j < kSize; ++j) {
      std::vector<Stages::Stage> needs;
      if (i > 0) needs.push_back((i - 1) * kSize + j);
      if (j > 0) needs.push_back(i * kSize + j - 1);
      stages.add(needs, [&paths, i, j] {
        paths[i][j] = i == 0 && j == 0 ? 1 : (i > 0 ? paths[i - 1][j] : 0) + (j > 0 ? paths[i][j - 1] : 0);
      });
    }
  }
  stages.run();
  EXPECT_EQ(paths[kSize - 1][kSize - 1], 70);  // 8 over 4
}

TEST(Stages, AfterAFailureNothingBeginsAndTheFirstInOrderIsThrown) {
  bool begun = false;
  std::atomic<bool> running = false, throwing = false;
  Stages stages;
  const auto first = stages.add({}, [] {});
  const auto broken = stages.add({first}, [&] {
    running = true;
    running.notify_all();
    throwing.wait(false);
    throw std::runtime_error("broken");
  });
  stages.add({broken}, [&begun] { begun = true; });
  stages.add({}, [&] {
    running.wait(false);
    throwing = true;
    throwing.notify_all();
    throw std::runtime_error("earlier, but later in order");
  });
  try {
    stages.run();
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()), "broken");
  }
  EXPECT_FALSE(begun);
}

}  // namespace
}  // namespace bodesmith::project
