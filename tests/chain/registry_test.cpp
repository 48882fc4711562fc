#include "chain/registry.hpp"

#include <gtest/gtest.h>

#include <latch>
#include <thread>
#include <vector>

#include "hysteresis/model_type.hpp"

namespace bodesmith::chain {
namespace {

/// Models of hysteresis become types of blocks when somebody asks first: in a program of its own (as tests are started one by one)
/// these threads do. `run` crashed there once in some hundred on a busy machine.
TEST(BlockTypes, ThreadsMayBeTheFirstToAsk) {
  constexpr std::size_t kThreads = 16;
  std::latch together(kThreads);
  std::vector<std::thread> threads;
  std::vector<std::size_t> found(kThreads, 0);
  for (std::size_t i = 0; i < kThreads; ++i) {
    threads.emplace_back([&, i] {
      together.arrive_and_wait();
      for (const auto* model : hysteresis::model_type_registry().all()) {
        if (make_block(model->name()).type().name() == model->name()) ++found[i];
      }
    });
  }
  for (std::thread& one : threads) one.join();
  for (const std::size_t count : found) EXPECT_EQ(count, hysteresis::model_type_registry().all().size());
}

}  // namespace
}  // namespace bodesmith::chain
