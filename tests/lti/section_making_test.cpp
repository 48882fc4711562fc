#include "lti/section_making.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace bodesmith {
namespace {

using Complex = std::complex<double>;

Complex product(double gain, const std::vector<Complex>& zeros, const std::vector<Complex>& poles,
                Complex s) {
  Complex h = gain;
  for (const Complex& z : zeros) h *= s - z;
  for (const Complex& p : poles) h /= s - p;
  return h;
}

TEST(MakeSections, ProductIsKeptWhateverTheMixture) {
  struct Case {
    std::vector<Complex> zeros;
    std::vector<Complex> poles;
  };
  const std::vector<Case> cases = {
      {{-1.0, -30.0}, {-5.0, -100.0}},
      {{{-3, 4}, {-3, -4}}, {-5.0, -100.0}},
      {{-2.0, -7.0, -9.0}, {{-1, 2}, {-1, -2}, -50.0}},
      {{{-3, 4}, {-3, -4}, {-30, 40}, {-30, -40}}, {-1.0, -2.0, -20.0, -90.0}},
      {{0.0}, {-4.0, -8.0}},
      {{}, {{-1, 5}, {-1, -5}, -2.0}},
  };
  for (const Case& c : cases) {
    for (const bool biquads : {false, true}) {
      const Sections sections = make_sections(2.5, c.zeros, c.poles, {.biquads = biquads});
      for (const double w : {0.1, 3.0, 77.0, 1e4}) {
        const Complex s(0.0, w);
        EXPECT_NEAR(std::abs(sections.response(s) / product(2.5, c.zeros, c.poles, s) - 1.0), 0.0, 1e-12);
      }
      for (const Section& section : sections.sections) EXPECT_LE(section.zeros.size(), section.poles.size());
    }
  }
  EXPECT_THROW(make_sections(1.0, {-1.0, -2.0}, {-3.0}), std::logic_error);
}

double span_of(const std::vector<Section>& sections, const std::vector<Hertz>& grid) {
  double worst = 0.0;
  std::vector<double> sum(grid.size(), 0.0);
  for (const Section& section : sections) {
    for (size_t j = 0; j < grid.size(); ++j)
      sum[j] += to_decibel(std::abs(section.response(grid[j].rad_s())));
    worst = std::max(worst,
                     *std::max_element(sum.begin(), sum.end()) - *std::min_element(sum.begin(), sum.end()));
  }
  return worst;
}

TEST(OrderSections, NoPairingAndOrderIsBetterOfFourSections) {
  const Band band{Hertz{0.2}, Hertz{2000.0}};
  const auto grid = log_grid(band, 121);
  std::mt19937 random(7);
  const auto place = [&](double) {
    return std::pow(10.0, 4.0 * static_cast<double>(random()) / 4294967295.0);
  };
  std::vector<double> zeros = {20.0, 900.0, 95.0, 4000.0}, poles = {3.0, 300.0, 2000.0, 60.0};
  for (int draw = 0; draw < 6; ++draw) {
    Sections given;
    for (size_t i = 0; i < 4; ++i) given.sections.push_back(Section::pole_zero(1.0, {zeros[i]}, {poles[i]}));
    const OrderedSections ordered = order_sections(given, band);
    double best = INFINITY;
    std::vector<size_t> pairing = {0, 1, 2, 3};
    do {
      std::vector<size_t> order = {0, 1, 2, 3};
      do {
        std::vector<Section> sections;
        for (const size_t i : order)
          sections.push_back(Section::pole_zero(1.0, {zeros[pairing[i]]}, {poles[i]}));
        best = std::min(best, span_of(sections, grid));
      } while (std::next_permutation(order.begin(), order.end()));
    } while (std::next_permutation(pairing.begin(), pairing.end()));
    EXPECT_TRUE(ordered.exhaustive);
    EXPECT_NEAR(ordered.span_after_db, best, 0.01);
    EXPECT_LE(ordered.span_after_db, ordered.span_before_db + 1e-9);
    // Stage by stage the signal's peak comes nearer to the whole's, by equal factors.
    const auto peak_behind = [&](std::size_t stages) {
      Sections behind = ordered.sections;
      behind.sections.resize(stages);
      double peak = 0.0;
      for (const Hertz f : grid) peak = std::max(peak, std::abs(behind.response(f.rad_s())));
      return peak;
    };
    EXPECT_EQ(ordered.sections.gain, 1.0);
    for (std::size_t i = 1; i <= 4; ++i)
      EXPECT_NEAR(peak_behind(i) / std::pow(peak_behind(4), 0.25 * static_cast<double>(i)), 1.0, 1e-9);
    for (const double w : {0.5, 40.0, 3000.0}) {
      EXPECT_NEAR(
          std::abs(ordered.sections.response(RadPerSecond{w}) / given.response(RadPerSecond{w}) - 1.0), 0.0,
          1e-12);
    }
    std::transform(zeros.begin(), zeros.end(), zeros.begin(), place);
    std::transform(poles.begin(), poles.end(), poles.begin(), place);
  }
}

TEST(OrderSections, BiquadsByOrderAloneAndEightSectionsQuickly) {
  Sections mixed;
  mixed.gain = -3.0;
  for (const auto& [zero, pole] : {std::pair{500.0, 90.0}, {400.0, 30.0}, {10.0, 400.0}, {70.0, 75.0}}) {
    Section s;
    s.zeros = {{-0.2 * zero, 0.5 * zero}, {-0.2 * zero, -0.5 * zero}};
    s.poles = {{-0.6 * pole, 0.8 * pole}, {-0.6 * pole, -0.8 * pole}};
    mixed.sections.push_back(s);
  }
  const Band band{Hertz{0.5}, Hertz{200.0}};
  const OrderedSections ordered = order_sections(mixed, band);
  const auto grid = log_grid(band, 121);
  std::vector<size_t> order = {0, 1, 2, 3};
  double best = INFINITY;
  do {
    std::vector<Section> sections;
    for (const size_t i : order) sections.push_back(mixed.sections[i]);
    best = std::min(best, span_of(sections, grid));
  } while (std::next_permutation(order.begin(), order.end()));
  EXPECT_NEAR(ordered.span_after_db, best, 1e-9);
  EXPECT_NEAR(span_of(ordered.sections.sections, grid), best, 1e-9);
  EXPECT_LT(best, ordered.span_before_db - 1.0);
  EXPECT_NEAR(
      std::abs(ordered.sections.response(RadPerSecond{33.0}) / mixed.response(RadPerSecond{33.0}) - 1.0), 0.0,
      1e-12);
  Sections eight;
  for (int i = 0; i < 8; ++i)
    eight.sections.push_back(Section::pole_zero(1.0, {std::pow(3.0, i)}, {std::pow(3.0, 7.5 - i)}));
  const OrderedSections pairs = order_sections(eight, {Hertz{0.1}, Hertz{1000.0}});
  EXPECT_TRUE(pairs.exhaustive);
  EXPECT_LT(pairs.span_after_db, pairs.span_before_db);
}

TEST(InSeries, GainsResponsesAndDelaysOfAllOfThem) {
  std::vector<Sections> parts(3);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const double w = 10.0 * static_cast<double>(i + 1);
    parts[i].gain = 0.5 + static_cast<double>(i);
    parts[i].delay_s = 1e-3 * static_cast<double>(i + 2);
    parts[i].sections = {Section::pole_zero(1.5, RadPerSecond{w}, RadPerSecond{3.0 * w})};
  }
  for (std::size_t count = 0; count <= parts.size(); ++count) {
    const Sections all = in_series({parts.begin(), parts.begin() + static_cast<std::ptrdiff_t>(count)});
    std::complex<double> wanted = 1.0;
    for (std::size_t i = 0; i < count; ++i) wanted *= parts[i].response(RadPerSecond{17.0});
    EXPECT_LT(std::abs(all.response(RadPerSecond{17.0}) - wanted), 1e-12) << count;
    EXPECT_EQ(all.sections.size(), count);
  }
}

/// The same response from sections of two poles; a pair of zeros stands with the poles that are nearest.
TEST(MakeSections, BiquadsAreTheSameAndZerosStandNearTheirPoles) {
  Sections given;
  given.gain = 3.0;
  given.sections = {
      {2.0, {-5.0}, {-1.0}}, {1.0, {}, {-20.0}}, {0.5, {-300.0}, {-200.0}}, {1.0, {}, {-4000.0}}};
  const Sections made = as_biquads(given);
  ASSERT_EQ(made.sections.size(), 2u);
  for (const Section& section : made.sections) EXPECT_EQ(section.poles.size(), 2u);
  for (const double w : {0.1, 30.0, 5e3}) {
    const Complex s(0.0, w);
    EXPECT_LT(std::abs(made.response(s) / given.response(s) - 1.0), 1e-12);
  }
  // Two slow real poles and a fast complex pair: the slow complex zeros do not go to the fast pair.
  const Sections apart =
      make_sections(1.0, {{-2.0, 3.0}, {-2.0, -3.0}}, {-1.0, -6.0, {-3e4, 4e4}, {-3e4, -4e4}}, {});
  for (const Section& section : apart.sections) {
    EXPECT_TRUE(section.zeros.empty() || std::abs(section.poles.front()) < 10.0);
  }
}

// In rising order they are nearest in all (in log frequency): each to the nearest pole, -5 would take -10 from -9.
TEST(MakeSections, AsManyRealZerosAsPolesPairInRisingOrder) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> decades(0.0, 3.0);
  for (int draw = 0; draw < 20; ++draw) {
    std::vector<Complex> zeros{-5.0, -9.0}, poles{-1.0, -10.0};
    for (int more = 0; more < draw % 4; ++more) {
      zeros.emplace_back(-std::pow(10.0, decades(random)));
      poles.emplace_back(-std::pow(10.0, decades(random)));
    }
    const Sections made = make_sections(1.0, zeros, poles);
    const auto rising = [](const Complex& a, const Complex& b) { return a.real() > b.real(); };
    std::ranges::sort(zeros, rising);
    std::ranges::sort(poles, rising);
    ASSERT_EQ(made.sections.size(), poles.size());
    for (std::size_t i = 0; i < poles.size(); ++i) {
      EXPECT_EQ(made.sections[i].poles, std::vector{poles[i]});
      EXPECT_EQ(made.sections[i].zeros, std::vector{zeros[i]});
    }
  }
}

}  // namespace
}  // namespace bodesmith
