#include "hysteresis/identification/record_tools.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <tuple>

#include "base/error.hpp"

namespace bodesmith::hysteresis {
namespace {

TimeRecord ramp(std::size_t samples, double from, double to) {
  TimeRecord out;
  out.file = "ramp.csv";
  out.step_s = 0.1;
  for (std::size_t i = 0; i < samples; ++i) {
    out.u.push_back(from + (to - from) * static_cast<double>(i) / static_cast<double>(samples - 1));
    out.y.push_back(10.0 * out.u.back() + 1.0);
  }
  return out;
}

TEST(RecordTools, TheCountedSamplesBeginAtTheTime) {
  const TimeRecord record = ramp(11, 0.0, 1.0);
  for (const auto& [skip, first] : {std::pair(0.0, 0),
                                    {-1.0, 0},
                                    {0.05, 1},
                                    {0.1, 1},
                                    {0.11, 2},
                                    {0.3, 3},
                                    {0.95, 10},
                                    {1.0, 10},
                                    {1.1, 10},
                                    {99.0, 10}})
    EXPECT_EQ(first_counted(record, skip), static_cast<std::size_t>(first)) << skip;
  const std::vector<TimeRecord> both = {record, ramp(6, 2.0, -3.0)};
  EXPECT_EQ(counted_samples(both, 0.0), 17u);
  EXPECT_EQ(counted_samples(both, 0.3), 8u + 3u);
  const Range in = input_range(both, 0.3), out = output_range(both, 0.3);
  EXPECT_NEAR(in.low, -3.0, 1e-12);
  EXPECT_NEAR(in.high, 1.0, 1e-12);
  EXPECT_NEAR(in.width(), 4.0, 1e-12);
  EXPECT_NEAR(in.middle(), -1.0, 1e-12);
  EXPECT_NEAR(out.low, -29.0, 1e-12);
  EXPECT_NEAR(out.high, 11.0, 1e-12);
  EXPECT_NEAR(input_range(both, 0.0).high, 2.0, 1e-12);
  const Eigen::VectorXd y = counted_outputs(both, 0.4);
  ASSERT_EQ(y.size(), 7 + 2);
  EXPECT_EQ(y(0), record.y[4]);
  EXPECT_EQ(y(7), both[1].y[4]);
  EXPECT_EQ(swept_range(both).low, -3.0);
  EXPECT_THROW(swept_range(std::vector{ramp(5, 1.0, 1.0)}), InputError);
}

TEST(RecordTools, BranchesEndAtTurnsThatCount) {
  using Cut = std::vector<std::tuple<std::size_t, std::size_t, bool>>;
  const auto cut = [](const std::vector<double>& u, double dead) {
    Cut out;
    for (const Branch& one : branches(u, dead)) out.emplace_back(one.first, one.last, one.rising);
    return out;
  };
  EXPECT_EQ(cut({0, 1, 2, 1, 0, 3}, 0.0), (Cut{{0, 2, true}, {2, 4, false}, {4, 5, true}}));
  EXPECT_EQ(cut({0, -1, -2, 2}, 0.0), (Cut{{0, 2, false}, {2, 3, true}}));
  // Moves up to the dead share of the range are no turns, and no beginning.
  EXPECT_EQ(cut({0, 4, 3, 10}, 0.1), (Cut{{0, 3, true}}));
  EXPECT_EQ(cut({0, 4, 2.9, 10}, 0.1), (Cut{{0, 1, true}, {1, 2, false}, {2, 3, true}}));
  EXPECT_EQ(cut({0, 1, 0, 10, 0}, 0.1), (Cut{{0, 3, true}, {3, 4, false}}));
  // Where it rests the branch goes on to the last of its highest.
  EXPECT_EQ(cut({0, 5, 5, 0}, 0.0), (Cut{{0, 2, true}, {2, 3, false}}));
  EXPECT_EQ(cut({1, 1, 1}, 0.0), Cut{});
  EXPECT_EQ(cut({1}, 0.0), Cut{});
}

TEST(RecordTools, GainsBetweenPolynomialsAreThoseOfTheirIntegrals) {
  const std::array<double, 3> p = {0.35, -0.64, 0.29}, q = {0.5, -0.7, 0.1};
  double pq = 0.0, pp = 0.0, qq = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const double x = (i + 0.5) / 20000.0;
    const auto at = [&](const std::array<double, 3>& a) { return x * (a[0] + x * (a[1] + x * a[2])); };
    pq += at(p) * at(q), pp += at(p) * at(p), qq += at(q) * at(q);
  }
  EXPECT_NEAR(disturbance_gain(p, q), pq / pp, 1e-6);
  EXPECT_NEAR(disturbance_gain(p, q, GainReading::as_printed), pq / qq, 1e-6);
  EXPECT_THROW(disturbance_gain({}, q), DesignError);
}

// The numbers put in, and what is left where the rest is alternately off by as much.
TEST(RecordTools, FitsHaveTheirCoefficientsAndWhatIsLeft) {
  std::vector<double> x, cubic, sine;
  for (int i = 0; i <= 100; ++i) {
    x.push_back(i / 100.0);
    const double off = 0.01 * (i % 2 == 0 ? 1.0 : -1.0);
    cubic.push_back(x.back() * (0.4 + x.back() * (-0.7 + x.back() * 0.3)) + off);
    sine.push_back(0.2 * std::sin(std::numbers::pi * x.back()) + off);
  }
  const PolynomialFit polynomial = fit_polynomial(x, cubic);
  EXPECT_NEAR(polynomial.a[0], 0.4, 2e-3);
  EXPECT_NEAR(polynomial.a[1], -0.7, 4e-3);
  EXPECT_NEAR(polynomial.a[0] + polynomial.a[1] + polynomial.a[2], 0.0, 1e-15);
  EXPECT_GT(polynomial.deviation[0], 0.0);
  const double found = fit_sine(x, sine);
  EXPECT_NEAR(found, 0.2, 1e-3);
  EXPECT_THROW(fit_polynomial(std::vector{0.5, 0.5}, std::vector{0.1, 0.1}), DesignError);
  EXPECT_THROW(fit_sine(std::vector{0.0}, std::vector{0.1}), DesignError);
  // The same amplitude searched for.
  const Eigen::VectorXd low = Eigen::VectorXd::Constant(1, -10.0), high = Eigen::VectorXd::Constant(1, 10.0);
  const LeastSquaresResult least = fit_parameters(
      [&](const Eigen::VectorXd& a, Eigen::VectorXd& r) {
        r.resize(101);
        for (int i = 0; i <= 100; ++i)
          r(i) = a(0) * std::sin(std::numbers::pi * x[std::size_t(i)]) - sine[std::size_t(i)];
      },
      Eigen::VectorXd::Constant(1, 1.0), low, high, high);
  EXPECT_NEAR(least.values(0), found, 1e-6);
}

}  // namespace
}  // namespace bodesmith::hysteresis
