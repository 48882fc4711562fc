#include "fit/measured/vector_fitting.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace bodesmith {
namespace {

using Roots = std::vector<std::complex<double>>;

std::complex<double> value_at(const RationalRoots& roots, std::complex<double> s) {
  std::complex<double> out = roots.gain;
  for (const auto& z : roots.zeros) out *= s - z;
  for (const auto& p : roots.poles) out /= s - p;
  return out;
}

double farthest(const Roots& wanted, const Roots& got) {
  double most = wanted.size() == got.size() ? 0.0 : 1e9;
  for (const auto& w : wanted) {
    double nearest = 1e9;
    for (const auto& g : got) nearest = std::min(nearest, std::abs(g - w));
    most = std::max(most, nearest);
  }
  return most;
}

ResponseSamples sampled(const RationalRoots& truth, double deviation) {
  ResponseSamples out;
  for (int i = 0; i < 60; ++i) {
    out.s.emplace_back(0.0, 0.02 * std::pow(50.0, i / 59.0));
    out.response.push_back(value_at(truth, out.s.back()));
    out.deviation.push_back(deviation * (1.0 + 0.5 * std::sin(i)));
  }
  return out;
}

const RationalRoots kTruth{{{-0.02, 0.3}, {-0.02, -0.3}, {-0.5, 0.0}, {-0.01, 0.8}, {-0.01, -0.8}},
                           {{-0.03, 0.5}, {-0.03, -0.5}, {0.7, 0.0}, {-0.2, 0.1}, {-0.2, -0.1}},
                           -0.4,
                           0.0};

// From real poles and from pairs, stable or not.
TEST(VectorFitting, ARationalResponseGivesItsRootsBack) {
  for (const Roots& start : {Roots{-0.1, -0.2, -0.4, -0.6, -0.9},
                             Roots{{0.01, 0.2}, {0.01, -0.2}, -0.3, {-0.1, 0.9}, {-0.1, -0.9}}}) {
    for (const double deviation : {1.0, 1e-4}) {
      const RationalRoots got = vector_fit(sampled(kTruth, deviation), start, 40);
      EXPECT_LT(farthest(kTruth.poles, got.poles), 1e-7);
      EXPECT_LT(farthest(kTruth.zeros, got.zeros), 1e-6);
      EXPECT_NEAR(got.gain, kTruth.gain, 1e-7);
      EXPECT_LT(got.cost * deviation * deviation, 1e-15);
      // Complex ones stand next to their conjugates.
      for (std::size_t i = 0; i < got.poles.size(); ++i) {
        if (got.poles[i].imag() == 0.0) continue;
        EXPECT_EQ(got.poles[i + 1], std::conj(got.poles[i]));
        ++i;
      }
    }
  }
}

// Disturbed: the cost is what its own roots leave of each point in deviations, all poles are stable, and no other residues
// do better; twice the deviations, the same roots.
TEST(VectorFitting, TheCostIsThatOfTheRootsAndTheLeastOne) {
  ResponseSamples samples = sampled(kTruth, 0.01);
  for (std::size_t i = 0; i < samples.s.size(); ++i)
    samples.response[i] += 0.02 * std::polar(1.0 + std::sin(7.0 * double(i)), 2.4 * double(i * i));
  const Roots start{-0.1, -0.2, -0.4};
  const RationalRoots got = vector_fit(samples, start, 40);
  const auto cost = [&](const RationalRoots& roots) {
    double out = 0.0;
    for (std::size_t i = 0; i < samples.s.size(); ++i)
      out += std::norm((value_at(roots, samples.s[i]) - samples.response[i]) / samples.deviation[i]);
    return out;
  };
  EXPECT_NEAR(cost(got) / got.cost, 1.0, 1e-8);
  for (const auto& p : got.poles) EXPECT_LT(p.real(), 0.0);
  for (const double by : {0.99, 1.01}) {
    RationalRoots other = got;
    other.gain *= by;
    EXPECT_GT(cost(other), got.cost);
  }
  for (double& d : samples.deviation) d *= 2.0;
  const RationalRoots again = vector_fit(samples, start, 40);
  EXPECT_LT(farthest(got.poles, again.poles), 1e-9);
  EXPECT_NEAR(again.cost * 4.0 / got.cost, 1.0, 1e-9);
}

}  // namespace
}  // namespace bodesmith
