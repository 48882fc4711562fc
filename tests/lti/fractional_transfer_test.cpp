#include "lti/fractional_transfer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/error.hpp"

namespace bodesmith {
namespace {

TEST(FractionalTransfer, PidIsTheSumOfItsParts) {
  const auto pid = FractionalTransfer::from_node(parse_toml(
      "schema = 'bodesmith.fractional/1'\npid = {kp = 1.5, ki = 4.0, lambda = 0.7, kd = 0.02, mu = 0.4}\n",
      "pid.toml"));
  for (const double w : {0.01, 1.0, 30.0, 1e4}) {
    const std::complex<double> s(0.0, w);
    const auto wanted = 1.5 + 4.0 * std::pow(s, -0.7) + 0.02 * std::pow(s, 0.4);
    EXPECT_NEAR(std::abs(pid.response(RadPerSecond{w}) / wanted - 1.0), 0.0, 1e-13);
  }
  EXPECT_NEAR(fractional_stability(pid.denominator).powers_of_s, 0.7, 1e-12);
}

TEST(FractionalTransfer, EqualPowersAreAddedAndWhatIsNothingIsLeftOut) {
  const FractionalPolynomial sum =
      collect_powers({{2.0, 0.7}, {1.0, 0.0}, {3.0, 1.4}, {0.5, 0.7}, {-3.0, 1.4}, {0.25, 0.0}});
  ASSERT_EQ(sum.size(), 2u);
  EXPECT_EQ(sum[0].coefficient, 1.25);
  EXPECT_EQ(sum[0].power, 0.0);
  EXPECT_EQ(sum[1].coefficient, 2.5);
  EXPECT_EQ(sum[1].power, 0.7);
}

TEST(FractionalTransfer, KnownStability) {
  // s^a + 1 has no zero on the principal sheet for a < 2 in Re s > 0, two beyond.
  EXPECT_EQ(fractional_stability({{1.0, 1.9}, {1.0, 0.0}}).unstable_poles, 0);
  EXPECT_EQ(fractional_stability({{1.0, 2.1}, {1.0, 0.0}}).unstable_poles, 2);
  EXPECT_EQ(fractional_stability({{1.0, 0.5}, {-1.0, 0.0}}).unstable_poles, 1);
  EXPECT_EQ(fractional_stability({{1.0, 1.0}, {-1.0, 0.0}}).unstable_poles, 1);
  EXPECT_EQ(fractional_stability({{1.0, 0.5}, {1.0, 0.0}}).unstable_poles, 0);
  // 1 + s^3: -1 and a pair at 60 degrees, by both counts; no step of the powers above 1 shows that.
  EXPECT_EQ(fractional_stability({{1.0, 3.0}, {1.0, 0.0}}).unstable_poles, 2);
  EXPECT_EQ(fractional_stability({{1.0, 3.0}, {1.0, 0.0}}).matignon_count, 2);
  // Matignon's example: s^1.2 roots may cross the axis as in integer order: s^2 - 0.1 s^1 + 1.
  EXPECT_EQ(fractional_stability({{1.0, 2.0}, {-0.1, 1.0}, {1.0, 0.0}}).unstable_poles, 2);
  EXPECT_LT(fractional_stability({{1.0, 2.0}, {1.0, 0.0}}).nearest_to_axis, 1e-3);
  // Powers that lie close, all terms equal at 1 rad/s: the two real zeros, of 1 - x - x^2 - x^3 + x^4 + x^5 + x^6, x = s^.02 =
  // .68 and .75, lie six decades and more below.
  FractionalPolynomial close;
  for (int k = 0; k <= 6; ++k) close.push_back({k == 0 || k > 3 ? 1.0 : -1.0, 0.02 * k});
  EXPECT_EQ(fractional_stability(close).unstable_poles, 2);
  EXPECT_EQ(fractional_stability(close).matignon_count, 2);
  // Powers without a common step: argument principle alone.
  const auto irrational = fractional_stability({{1.0, std::sqrt(2.0)}, {0.4, 1.0 / M_PI}, {1.0, 0.0}});
  EXPECT_EQ(irrational.unstable_poles, 0);
  EXPECT_FALSE(irrational.matignon_count.has_value());
}

TEST(FractionalTransfer, ArgumentPrincipleAgreesWithMatignon) {
  std::mt19937 chance(11);
  std::normal_distribution<double> coefficient;
  std::uniform_int_distribution<int> numerator(1, 24);
  std::uniform_int_distribution<int> denominator(2, 8);
  int unstable = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const int q = denominator(chance);
    std::vector<FractionalPower> terms = {{coefficient(chance), 0.0}};
    for (int i = 0; i < 3; ++i)
      terms.push_back({coefficient(chance), static_cast<double>(numerator(chance)) / q});
    const auto result = fractional_stability(terms);
    ASSERT_TRUE(result.matignon_count.has_value());
    if (result.nearest_to_axis < 1e-4) continue;
    EXPECT_EQ(result.unstable_poles, *result.matignon_count) << trial;
    unstable += result.unstable_poles > 0 ? 1 : 0;
  }
  EXPECT_GT(unstable, 30);
}

TEST(FractionalTransfer, RefusesWithFileAndLine) {
  const auto read = [](const std::string& text) {
    return FractionalTransfer::from_node(parse_toml("schema = 'bodesmith.fractional/1'\n" + text, "g.toml"));
  };
  EXPECT_THROW(read("pid = {}"), InputError);
  EXPECT_THROW(read("pid = {ki = 1.0}"), InputError);
  EXPECT_THROW(
      read("numerator = [{coefficient = 1, power = -1}]\ndenominator = [{coefficient = 1, power = 0}]"),
      InputError);
  EXPECT_THROW(read("numerator = []\ndenominator = [{coefficient = 1, power = 0}]"), InputError);
  EXPECT_THROW(read("numerator = [{coefficient = 1, power = 0, order = 3}]\ndenominator = [{coefficient = 1, "
                    "power = 0}]"),
               InputError);
  EXPECT_THROW(
      read("numerator = [{coefficient = 0, power = 0}]\ndenominator = [{coefficient = 1, power = 0}]"),
      InputError);
  EXPECT_THROW(read("pid = {kp = 1.0}\nnumerator = [{coefficient = 1, power = 0}]"), InputError);
  EXPECT_NO_THROW(read("pid = {kp = 1.0}"));
  try {
    read("\nnumerator = [{coefficient = 'a', power = 0}]\ndenominator = [{coefficient = 1, power = 0}]");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("g.toml:3"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace bodesmith
