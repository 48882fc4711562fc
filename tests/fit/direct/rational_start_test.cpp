// The bound by alternation, and the fits it proves best.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <mutex>
#include <utility>
#include <vector>

#include "fit/direct/curve_target.hpp"
#include "fit/direct/direct_fit.hpp"
#include "fit/direct/rational_start.hpp"
#include "fit/direct/start_builder.hpp"

namespace bodesmith {
namespace {

TEST(Alternation, TheLevelIsThatOfTheBestAlternatingErrors) {
  EXPECT_EQ(alternating_level({1.0, -2.0, 3.0, -4.0}, 4), 1.0);
  EXPECT_EQ(alternating_level({1.0, -2.0, 3.0, -4.0}, 3), 2.0);
  // Runs of one sign count once, by their largest.
  EXPECT_EQ(alternating_level({1.0, 5.0, 0.0, 2.0, -3.0, -1.0, 4.0}, 3), 3.0);
  // A dip inside goes with the smaller of its neighbours.
  EXPECT_EQ(alternating_level({3.0, -4.0, 0.1, -2.0, 5.0}, 3), 3.0);
  EXPECT_EQ(alternating_level({3.0, -4.0, 5.0}, 4), 0.0);
  EXPECT_EQ(alternating_level({}, 2), 0.0);
}

BodePoints dense_curve(double from, double to, int count, double (*gain)(double)) {
  BodePoints out;
  for (const Hertz f : log_grid({Hertz{from}, Hertz{to}}, count))
    out.points.push_back({f, gain(f.value), std::nullopt, 1.0, 0});
  return out;
}

double pink_gain(double f) {
  return 1.0 / std::sqrt(f);
}
/// Two resonances on a slope: no rational function of low order.
double peaked_gain(double f) {
  const auto peak = [f](double at, double q) {
    const double x = f / at - at / f;
    return 1.0 + 3.0 / (1.0 + q * q * x * x);
  };
  return peak(200.0, 4.0) * peak(3000.0, 7.0) / std::pow(f, 0.3);
}

/// What many starts find, and what the bound says of it.
void expect_best_fit(const BodePoints& points, int order) {
  const DirectFit fit = fit_directly(points, {.order = order});
  EXPECT_LT(fit.starts_tried, 12) << order;
  // The sections themselves, as a model again.
  const CurveTarget target = make_curve_target(points, false);
  std::vector<double> errors;
  for (const BodePoint& p : points.points)
    errors.push_back(to_decibel(std::abs(fit.sections.response(p.frequency.rad_s())) / p.gain));
  const double level = alternating_level(errors, static_cast<std::size_t>(2 * order + 2));
  EXPECT_GT(level, 0.998 * fit.max_db) << order;
}

TEST(Alternation, DenseFitsEndWhereNothingBetterExists) {
  for (const int order : {2, 4, 6, 8}) expect_best_fit(dense_curve(20, 20000, 400, pink_gain), order);
  expect_best_fit(dense_curve(20, 20000, 400, peaked_gain), 4);
}

TEST(Alternation, ABoundIsNeverAboveAFit) {
  // A fit far from the best, and the best one: the bound of the first lies below the error of the second.
  const BodePoints points = dense_curve(20, 20000, 200, pink_gain);
  const CurveTarget target = make_curve_target(points, false);
  const RootModel model = StartBuilder::make_model(3, 3, true, RadPerSecond{6000.0});
  RootLimits limits;
  const auto start = rational_start(model, target, limits);
  ASSERT_TRUE(start.has_value());
  const double best = fit_directly(points, {.order = 3}).max_db / kDecibelPerNeper;
  for (const double shift : {0.0, 0.02, 0.3}) {
    Eigen::VectorXd theta = *start;
    theta(2) += shift;
    EXPECT_LE(alternation_bound(model, target, theta), best * (1.0 + 1e-9));
  }
}

TEST(RationalStart, IsCloseToTheBestFit) {
  const CurveTarget target = make_curve_target(dense_curve(20, 20000, 160, pink_gain), false);
  const RootModel model = StartBuilder::make_model(6, 6, false, RadPerSecond{6000.0});
  const auto start = rational_start(model, target, RootLimits());
  ASSERT_TRUE(start.has_value());
  Eigen::VectorXd error;
  curve_errors(model, target, *start, error, nullptr);
  EXPECT_LT(error.cwiseAbs().maxCoeff() * kDecibelPerNeper, 3.0 * 0.0076);
}

TEST(RationalStart, FewPointsHaveNone) {
  const CurveTarget target = make_curve_target(dense_curve(20, 20000, 12, pink_gain), false);
  const RootModel model = StartBuilder::make_model(4, 4, false, RadPerSecond{6000.0});
  EXPECT_FALSE(rational_start(model, target, RootLimits()).has_value());
}

/// Pairs that begin as real roots have these roots' response; what was added to a smaller model nearly cancels: real roots within
/// e^±.15 of one another, dampings of .6 and .9 at one place.
TEST(StartBuilder, StartsAreEvenOrNearlyASmallerModel) {
  const RadPerSecond low{10.0}, high{1e5};
  for (const bool real : {true, false}) {
    std::mutex lock;
    std::vector<std::pair<RootModel, Eigen::VectorXd>> starts;
    const auto keep = [&](const RootModel& model, const Eigen::VectorXd& theta) {
      const std::lock_guard hold(lock);
      starts.emplace_back(model, theta);
      return SearchResult{theta, static_cast<double>(starts.size())};
    };
    StartBuilder({.low = low, .high = high, .real = real, .random = 0}, keep).build(4, 4, RadPerSecond{1.0});
    const double farthest = real ? 0.3 : std::log(1.5);
    int even = 0;
    for (const auto& start : starts) {
      const RootModel& model = start.first;
      const Eigen::VectorXd& theta = start.second;
      if (model.zeros() != 4) continue;
      const auto distance = [&](const std::function<double(double)>& log_gain_at) {
        double most = 0.0;
        for (double w = 1.0; w < 1e7; w *= 1.3)
          most = std::max(most, std::abs(model.log_response(theta, RadPerSecond{w}).real() - log_gain_at(w)));
        return most;
      };
      double nearest = INFINITY;
      for (const double shift : {0.2, -0.2}) {
        const double spread = distance([&](double w) {
          double sum = 0.0;
          for (const double sign : {1.0, -1.0}) {
            for (int i = 0; i < 4; ++i) {
              const double corner =
                  low.value * std::pow(high.value / low.value, (i + 0.5 + sign * shift) / 4.0);
              sum += 0.5 * sign * std::log((corner * corner + w * w) / (corner * corner + 1.0));
            }
          }
          return sum;
        });
        even += spread < 1e-6 ? 1 : 0;
        nearest = std::min(nearest, spread);
      }
      for (const auto& smaller : starts) {
        if (smaller.first.zeros() < 4)
          nearest = std::min(nearest, distance([&](double w) {
                               return smaller.first.log_response(smaller.second, RadPerSecond{w}).real();
                             }));
      }
      EXPECT_LE(nearest, farthest) << theta;
    }
    EXPECT_EQ(even, 2);
  }
}

// Root by root and frequency by frequency give the same errors and slopes.
TEST(CurveErrors, DenseCurvesAgreeWithOneFrequencyAtATime) {
  const CurveTarget target = make_curve_target(dense_curve(1, 1e5, 150, pink_gain), false);
  RootModel model;
  model.reference = {500.0};
  model.real_zeros = model.real_poles = 1;
  model.zero_pairs = model.pole_pairs = 1;
  Eigen::VectorXd theta(model.size());
  theta << 0.3, 4.0, 7.0, -0.8, 6.0, 9.0, 0.4;
  Eigen::VectorXd error;
  Eigen::MatrixXd slope;
  curve_errors(model, target, theta, error, &slope);
  Eigen::RowVectorXcd row;
  for (std::size_t i = 0; i < target.frequency.size(); i += 7) {
    const auto value = model.log_response(theta, target.frequency[i], &row);
    const auto at = static_cast<Eigen::Index>(i);
    EXPECT_NEAR(error(at), value.real() - target.log_gain[i], 1e-12);
    for (Eigen::Index k = 0; k < theta.size(); ++k) EXPECT_NEAR(slope(at, k), row(k).real(), 1e-11) << k;
  }
}

// The product of the roots is the exponential of their logarithms' sum, and its slopes are the same.
TEST(RootResponse, AProductIsTheExponentialOfTheSum) {
  RootModel model;
  model.reference = {500.0};
  model.real_zeros = model.real_poles = 2;
  model.zero_pairs = model.pole_pairs = 1;
  Eigen::VectorXd theta(model.size());
  theta << 0.3, 4.0, 5.5, 7.0, -0.8, 6.0, 9.0, 3.0, 0.4;
  const RootResponse response(model, theta);
  const std::vector<RadPerSecond> w = {{1e-3}, {10.0}, {400.0}, {5e3}, {1e7}};
  Eigen::VectorXcd product, alone;
  Eigen::MatrixXcd slope(1, theta.size());
  response.values(w, product, &slope);
  response.values(w, alone, nullptr);
  EXPECT_EQ(product, alone);
  ASSERT_EQ(slope.rows(), static_cast<Eigen::Index>(w.size()));
  Eigen::RowVectorXcd by_log(theta.size());
  for (Eigen::Index i = 0; i < product.size(); ++i) {
    const auto wanted = std::exp(response.at(w[static_cast<std::size_t>(i)], &by_log, true));
    EXPECT_LT(std::abs(product(i) - wanted), 1e-13 * std::abs(wanted)) << i;
    EXPECT_LT((slope.row(i) - by_log).cwiseAbs().maxCoeff(), 1e-14) << i;
  }
}

}  // namespace
}  // namespace bodesmith
