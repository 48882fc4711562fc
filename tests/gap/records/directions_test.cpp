#include "gap/records/directions.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace bodesmith {
namespace {

TEST(Directions, AreOrthonormalAndOfWhatIsNew) {
  gap::Directions all;
  all.add({3.0, 0.0, 4.0});
  all.add({0.0, 0.0, 0.0});
  all.add({NAN, 1.0, 0.0});
  all.add({6.0, 0.0, 8.0 + 1e-6});
  ASSERT_EQ(all.all().size(), 1U);
  EXPECT_NEAR(all.all()[0][0], 0.6, 1e-15);
  all.add({1.0, 2.0, 1.0});
  ASSERT_EQ(all.all().size(), 2U);
  double dot = 0.0, norm = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    dot += all.all()[0][i] * all.all()[1][i];
    norm += all.all()[1][i] * all.all()[1][i];
  }
  EXPECT_NEAR(dot, 0.0, 1e-15);
  EXPECT_NEAR(norm, 1.0, 1e-15);
  // What is left of a signal is across both; what they explain leaves nothing.
  std::vector<double> v = {5.0, -1.0, 2.0};
  all.take_out(v);
  for (const auto& direction : all.all())
    EXPECT_NEAR(v[0] * direction[0] + v[1] * direction[1] + v[2] * direction[2], 0.0, 1e-14);
  std::vector<double> known = {3.0 + 1.0, 2.0, 4.0 + 1.0};
  all.take_out(known);
  for (const double x : known) EXPECT_NEAR(x, 0.0, 1e-14);
  // Nearly parallel ones are orthogonal after the second time.
  gap::Directions near;
  near.add({1.0, 1.0, 1.0});
  near.add({1.0, 1.0, 1.0 + 3e-5});
  ASSERT_EQ(near.all().size(), 2U);
  EXPECT_NEAR(near.all()[1][0] + near.all()[1][1] + near.all()[1][2], 0.0, 1e-14);
}

}  // namespace
}  // namespace bodesmith
