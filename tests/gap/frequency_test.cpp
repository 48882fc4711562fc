#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "base/document.hpp"
#include "chain/model_file.hpp"
#include "gap/search.hpp"
#include "gap/verdict.hpp"

namespace {

using namespace bodesmith;

FrequencyRecord response(double from, double to, int count, double noise, unsigned seed,
                         const std::function<std::complex<double>(std::complex<double>)>& h) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, noise);
  FrequencyRecord r;
  r.file = "response.csv";
  for (int i = 0; i < count; ++i) {
    const double hz = from * std::pow(to / from, i / (count - 1.0));
    const std::complex<double> s(0.0, 2 * std::numbers::pi * hz);
    r.frequency.push_back(Hertz{hz});
    r.response.push_back(h(s) * (1.0 + std::complex<double>(normal(random), normal(random))));
  }
  return r;
}

constexpr const char* kModel = R"(schema = "bodesmith.model/1"
[[block]]
type = "resonator"
gain = 1.0
natural_frequency_hz = 300.0
damping_ratio = 0.1
free = ["gain", "natural_frequency_hz", "damping_ratio"]
)";

std::complex<double> mode(std::complex<double> s) {
  const double w = 2 * std::numbers::pi * 310.0;
  return 0.9 / (1.0 + 0.22 * s / w + s * s / (w * w));
}

gap::SearchResult search(const FrequencyRecord& a, const FrequencyRecord& b) {
  static std::vector<std::unique_ptr<gap::FrequencyExperiment>> keep;
  keep.push_back(std::make_unique<gap::FrequencyExperiment>(a));
  keep.push_back(std::make_unique<gap::FrequencyExperiment>(b));
  const auto base = chain::model_from_node(parse_toml(kModel, "model.toml"));
  return gap::search(base, {keep[keep.size() - 2].get()}, {keep.back().get()}, {});
}

TEST(FrequencyResponse, aDelayIsNamed) {
  const auto late = [](std::complex<double> s) { return mode(s) * std::exp(-s * 2e-4); };
  const auto result = search(response(5, 2000, 120, 0.004, 1, late), response(8, 1500, 90, 0.004, 2, late));
  ASSERT_EQ(result.steps.size(), 1U);
  EXPECT_EQ(result.steps[0].effect->name(), "time_delay");
  EXPECT_NEAR(result.final.terms()[0].unknowns[0].value, 2e-4, 4e-6);
}

TEST(FrequencyResponse, nothingIsNamedInNoise) {
  const auto result = search(response(5, 2000, 120, 0.01, 3, mode), response(8, 1500, 90, 0.01, 4, mode));
  EXPECT_TRUE(result.steps.empty());
  EXPECT_EQ(gap::verdict_of(result, 0.01, 1.2), gap::Verdict::nothing_missing);
}

}  // namespace
