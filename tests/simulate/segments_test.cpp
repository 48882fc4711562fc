// What a report says about which engine does what.
#include "simulate/simulate.hpp"

#include <gtest/gtest.h>

#include "chain/registry.hpp"

namespace bodesmith::simulate {
namespace {

using chain::make_block;

TEST(Segments, NeighboursWorkedOutAlikeAreOne) {
  const chain::Chain chain{{make_block("lowpass").set("corner_hz", 3.0), make_block("gain").set("gain", 2.0),
                            make_block("polynomial").set("coefficients", std::vector<double>{0.0, 1.0, 0.3}),
                            make_block("delay").set("delay_s", 0.1)}};
  const auto record = segments_of(chain, Engine::record);
  ASSERT_EQ(record.size(), 3u);
  EXPECT_EQ(record[0].last, 2u);
  EXPECT_EQ(record[0].method, "matrix exponential on each hold");
  EXPECT_EQ(record[1].method, "value by value");
  const auto cvode = segments_of(chain, Engine::cvode);
  ASSERT_EQ(cvode.size(), 2u);
  EXPECT_EQ(cvode[0].last, 3u);
  EXPECT_EQ(cvode[1].method, "delay, shifted");
  EXPECT_EQ(segments_of(chain, Engine::exact).size(), 1u);
}

TEST(Segments, EnginesHaveNames) {
  EXPECT_EQ(to_string(Engine::automatic), "automatic");
  EXPECT_EQ(to_string(Engine::record), "record");
  EXPECT_EQ(to_string(Engine::exact), "exact");
  EXPECT_EQ(to_string(Engine::cvode), "cvode");
}

}  // namespace
}  // namespace bodesmith::simulate
