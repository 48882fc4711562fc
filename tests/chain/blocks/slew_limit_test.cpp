// slew_limit with feedthrough: the part of an edge that passes at once.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "base/error.hpp"
#include "chain/kernel.hpp"
#include "chain/model_file.hpp"
#include "chain/registry.hpp"

namespace bodesmith::chain {
namespace {

std::unique_ptr<MemoryKernel> limiter(double rate, double feedthrough) {
  auto kernel = make_block("slew_limit").set("rate_per_s", rate).set("feedthrough", feedthrough).kernel();
  return std::move(std::get<std::unique_ptr<MemoryKernel>>(kernel));
}

TEST(SlewLimit, AnEdgePartlyPassesAtOnce) {
  const auto k = limiter(2.0, 0.1);
  EXPECT_EQ(k->reset(0.0, false), 0.0);
  EXPECT_NEAR(k->step(1.0, 0.0), 0.1, 1e-15);
  // Then x = 2 t until it meets the input at 0.5 s.
  for (int i = 1; i <= 10; ++i) {
    const double x = std::min(1.0, 0.2 * i);
    EXPECT_NEAR(k->step(1.0, 0.1), x + 0.1 * (1.0 - x), 1e-12) << i;
  }
}

TEST(SlewLimit, ZeroFeedthroughIsThePlainLimit) {
  const auto plain = limiter(3.0, 0.0);
  EXPECT_EQ(plain->slew_rate(), 3.0);
  plain->reset(0.0, false);
  EXPECT_NEAR(plain->step(1.0, 0.1), 0.3, 1e-15);
  EXPECT_NEAR(plain->peek(1.0, 0.1), 0.6, 1e-15);
}

TEST(SlewLimit, FollowsAStraightInputExactlyWhateverTheStep) {
  // The same input in long straight pieces and cut into a thousand parts each.
  std::mt19937_64 random(5);
  const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1.0p-53; };
  const auto whole = limiter(4.0, 0.15);
  const auto parts = limiter(4.0, 0.15);
  EXPECT_EQ(whole->reset(0.0, true), parts->reset(0.0, true));
  double u = 0.0;
  for (int i = 0; i < 200; ++i) {
    const double next = 2.0 * unit() - 1.0;
    const double last = whole->step(next, 0.1);
    double cut = 0.0;
    for (int k = 1; k <= 1000; ++k) cut = parts->step(u + (next - u) * k / 1000.0, 1e-4);
    EXPECT_NEAR(last, cut, 1e-11) << i;
    u = next;
  }
}

TEST(SlewLimit, FeedthroughIsReadWrittenAndChecked) {
  const std::string head =
      "schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"slew_limit\"\nrate_per_s = 5.0\n";
  const auto chain = model_from_node(parse_toml(head + "feedthrough = 0.25\n", "model.toml"));
  EXPECT_EQ(chain.blocks[0].get("feedthrough"), 0.25);
  const auto again = model_from_node(parse_toml(model_text(chain), "model.toml"));
  EXPECT_EQ(again.blocks[0].get("feedthrough"), 0.25);
  EXPECT_EQ(model_from_node(parse_toml(head, "model.toml")).blocks[0].get("feedthrough"), 0.0);
  try {
    model_from_node(parse_toml(head + "feedthrough = -0.1\n", "model.toml"));
    FAIL() << "a negative feedthrough was taken";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("model.toml:5"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("feedthrough"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace bodesmith::chain
