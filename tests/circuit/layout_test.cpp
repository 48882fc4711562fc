#include "circuit/layout.hpp"

#include <gtest/gtest.h>

namespace bodesmith {
namespace {

Disturbance seed_disturbance() {
  Disturbance d;
  d.ascending = {0.3546, -0.6433, 0.2887};
  d.descending = {-0.2398, 0.0838, 0.156};
  return d;
}

TEST(Layout, SeedPolynomials) {
  const DisturbanceLayout layout = layout_disturbance(seed_disturbance());
  std::puts(to_text(layout.to_json()).c_str());
  EXPECT_EQ(layout.multipliers.size(), 2u);
  EXPECT_LT(layout.max_error_percent, 0.04);
}

}  // namespace
}  // namespace bodesmith
