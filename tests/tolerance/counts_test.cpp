#include "tolerance/counts.hpp"

#include <gtest/gtest.h>

namespace bodesmith::tolerance {
namespace {

/// Two frequencies, ranges -2 to 2 dB and -8 to 8 degrees; worst 0 to 4.
Result shape() {
  Result out;
  for (int i = 0; i < 2; ++i) {
    out.magnitude_db.push_back({-2.0, 2.0, {}, 0.0, 0.0});
    out.phase_deg.push_back({-8.0, 8.0, {}, 0.0, 0.0});
  }
  out.worst_db = out.worst_deg = out.worst_percent = {0.0, 4.0, {}, 0.0, 0.0};
  return out;
}

TEST(Histogram, QuantilesAreStraightWithinABin) {
  Histogram h{0.0, 4.0, {1, 0, 2, 1}, 0.5, 3.75};
  EXPECT_EQ(h.quantile(0.0), 0.5);
  EXPECT_EQ(h.quantile(1.0), 3.75);
  EXPECT_EQ(h.quantile(1e-9), 0.5);  // not below what was seen
  EXPECT_NEAR(h.quantile(0.2), 0.8, 1e-12);
  EXPECT_NEAR(h.quantile(0.25), 1.0, 1e-12);
  EXPECT_NEAR(h.quantile(0.5), 2.5, 1e-12);
  EXPECT_NEAR(h.quantile(0.75), 3.0, 1e-12);
  EXPECT_NEAR(h.quantile(0.9), 3.6, 1e-12);
  EXPECT_EQ(h.quantile(0.99), 3.75);
  EXPECT_EQ((Histogram{0.0, 4.0, {0, 0}, 1.0, 2.0}.quantile(0.5)), 0.0);
}

TEST(Counts, PartsOfARunAddUpToTheWhole) {
  Counts whole(shape()), first(shape()), second(shape());
  for (int n = 0; n < 10; ++n) {
    for (Counts* to : {&whole, n < 4 ? &first : &second}) {
      to->add(0, -2.5 + 0.5 * n, -7.0 + n);
      to->add(1, 0.1 * n, 0.0);
      to->add_worst(0.3 * n, 0.4 * n, 0.1 * n, n % 3 == 0);
    }
  }
  first.merge(second);
  EXPECT_EQ(first.bytes(), whole.bytes());
  Counts back(shape());
  EXPECT_TRUE(back.from_bytes(whole.bytes()));
  EXPECT_EQ(back.bytes(), whole.bytes());
  EXPECT_EQ(back.samples(), 10u);
  std::string damaged = whole.bytes();
  damaged[20] ^= 1;
  EXPECT_FALSE(back.from_bytes(damaged));
  EXPECT_FALSE(back.from_bytes(whole.bytes().substr(1)));
  Result result = shape();
  first.put_into(result);
  EXPECT_EQ(result.samples, 10u);
  EXPECT_EQ(result.within, 4u);
  EXPECT_EQ(result.magnitude_db[0].min, -2.5);  // beyond its range, in the first bin
  EXPECT_EQ(result.magnitude_db[0].counts.front(), 2u);
  EXPECT_EQ(result.magnitude_db[0].max, 2.0);
  EXPECT_EQ(result.magnitude_db[0].counts.back(), 1u);
  EXPECT_EQ(result.magnitude_db[0].counts[Counts::kBins / 2], 1u);
  EXPECT_EQ(result.phase_deg[0].max, 2.0);
  EXPECT_NEAR(result.magnitude_db[1].max, 0.9, 1e-15);
  EXPECT_NEAR(result.worst_db.max, 2.7, 1e-15);
  EXPECT_NEAR(result.worst_deg.max, 3.6, 1e-15);
  EXPECT_NEAR(result.worst_percent.max, 0.9, 1e-15);
}

}  // namespace
}  // namespace bodesmith::tolerance
