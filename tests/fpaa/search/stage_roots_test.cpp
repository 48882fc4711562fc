#include "fpaa/search/stage_roots.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "fpaa/search/sine_response.hpp"

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;

SharingOptions options() {
  SharingOptions out;
  out.far_zero = 1e9;
  return out;
}

TEST(StageRoots, ZerosGoToTheLowestPolesOrToTheNearest) {
  Sections riaa;
  riaa.sections = {{1.0, {-3144.7}, {-314.5}}, {1.0, {}, {-13333.0}}};
  SharingOptions how = options();
  const auto lowest = shared_roots(riaa, how);
  ASSERT_EQ(lowest.size(), 2u);
  for (const StageRoots& stage : lowest) EXPECT_EQ(stage.zeros.size(), stage.corner() < 1000.0 ? 1u : 0u);
  how.nearest_zeros = true;
  for (const StageRoots& stage : shared_roots(riaa, how))
    EXPECT_EQ(stage.zeros.size(), stage.corner() < 1000.0 ? 0u : 1u);
}

TEST(StageRoots, ComplexZerosGoToTheNearestPair) {
  const auto pair_at = [](double w) {
    return std::vector<Complex>{w * Complex(-0.1, 0.995), w * Complex(-0.1, -0.995)};
  };
  const auto kinds = [&](double zeros_at) {
    Sections sections;
    sections.sections = {{1.0, pair_at(zeros_at), pair_at(1000.0)}, {1.0, {}, {-100.0}}, {1.0, {}, {-121.0}}};
    std::vector<std::pair<std::size_t, std::size_t>> out;  // poles and zeros of each stage
    for (const StageRoots& stage : shared_roots(sections, options()))
      out.emplace_back(stage.poles.size(), stage.zeros.size());
    return out;
  };
  using Kinds = std::vector<std::pair<std::size_t, std::size_t>>;
  EXPECT_EQ(kinds(900.0), (Kinds{{2, 2}, {1, 0}, {1, 0}}));
  EXPECT_EQ(kinds(340.0), (Kinds{{2, 2}, {1, 0}, {1, 0}}))
      << "nearer to 1000 than to the geometric mean of 110";
  EXPECT_EQ(kinds(320.0), (Kinds{{2, 0}, {2, 2}}));
}

TEST(StageRoots, ClosestPairsAreLeftOutFirst) {
  Sections sections;
  sections.sections = {{1.0, {-110.0}, {-100.0}}, {1.0, {-1010.0}, {-1000.0}}, {1.0, {-9000.0}, {-5000.0}}};
  SharingOptions how = options();
  how.left_out = 1;
  const auto two = shared_roots(sections, how);
  ASSERT_EQ(two.size(), 2u);
  for (const StageRoots& stage : two) EXPECT_NE(stage.poles[0].real(), -1000.0);
  how.left_out = 3;
  EXPECT_TRUE(shared_roots(sections, how).empty());
}

TEST(StageRoots, MoreZerosThanPolesHaveNoStage) {
  Sections sections;
  sections.sections = {{1.0, {-11.0, -12.0}, {-10.0}}};
  EXPECT_TRUE(shared_roots(sections, options()).empty());
}

TEST(StageRoots, LowestAndHighestJoin) {
  Sections sections;
  sections.sections = {{1.0, {-11.0}, {-10.0}}, {1.0, {-110.0}, {-100.0}}, {1.0, {-9000.0}, {-5000.0}}};
  SharingOptions how = options();
  how.joined = 1;
  const auto stages = shared_roots(sections, how);
  ASSERT_EQ(stages.size(), 2u);
  EXPECT_EQ(stages[0].poles, (std::vector<Complex>{-10.0, -5000.0}));
  EXPECT_EQ(stages[0].zeros, (std::vector<Complex>{-11.0, -9000.0}));
  EXPECT_TRUE(stages[0].second);
  EXPECT_FALSE(stages[1].second);
  // Nothing is left to join the one in the middle with.
  how.joined = 2;
  EXPECT_TRUE(shared_roots(sections, how).empty());
}

/// At a fast clock every kind of stage is its analog self, but for sign and gain.
TEST(StageRoots, InitialCapacitorsMakeTheRoots) {
  const double w0 = 2.0 * M_PI * 1000.0;
  const Complex p(-0.4 * w0, 0.9165 * w0);
  const Complex z(-0.2 * w0, 1.3 * w0);
  const Complex right(0.4 * w0, 0.9165 * w0);
  const std::vector<StageRoots> all = {{{-w0}, {}},
                                       {{-w0}, {0.0}},
                                       {{-w0}, {-2.0 * w0}},
                                       {{-w0}, {2.0 * w0}, false, true},
                                       {{p, std::conj(p)}, {}, true},
                                       {{p, std::conj(p)}, {0.0}, true},
                                       {{p, std::conj(p)}, {0.0, 0.0}, true},
                                       {{p, std::conj(p)}, {z, std::conj(z)}, true},
                                       {{p, std::conj(p)}, {right, std::conj(right)}, true, true}};
  DesignTarget target;
  target.master_hz = 16e6;
  for (const double f : {300.0, 800.0, 2500.0}) target.grid.push_back(Hertz{f}.rad_s());
  const StageFactorTable table(target);
  for (std::size_t n = 0; n < all.size(); ++n) {
    Design design;
    design.stages = initial_stages(all[n], 2e6);
    ASSERT_EQ(design.stages.size(), all[n].subtract ? 2u : 1u) << n;
    for (DesignStage& stage : design.stages) stage.divisor = 8;
    const DesignResponse response(design, table);
    const auto analog = [&](std::size_t k) {
      Complex out = 1.0;
      for (const Complex& zero : all[n].zeros) out *= Complex(0.0, target.grid[k].value) - zero;
      for (const Complex& pole : all[n].poles) out /= Complex(0.0, target.grid[k].value) - pole;
      return out;
    };
    const Complex gain = response.output(0) / analog(0);
    for (std::size_t k = 1; k < target.grid.size(); ++k) {
      EXPECT_NEAR(std::abs(response.output(k) / analog(k) / gain - 1.0), 0.0, 0.02) << n;
    }
  }
}

/// What is subtracted from its own input is right at rest at any clock, of low and of high quality: prod(z)/prod(p).
TEST(StageRoots, DifferencesAreRightAtRest) {
  const double w0 = 2.0 * M_PI * 1000.0;
  const Complex right(0.3 * w0, 1.25 * w0);
  for (const double damping : {0.1, 0.6}) {
    const Complex p(-damping * w0, std::sqrt(1.0 - damping * damping) * w0);
    for (const std::int64_t divisor : {80, 800}) {
      DesignTarget target;
      target.master_hz = 16e6;
      target.grid = {Hertz{0.01}.rad_s()};
      Design design;
      design.stages =
          initial_stages({{p, std::conj(p)}, {right, std::conj(right)}, true, true}, 16e6 / divisor);
      ASSERT_EQ(design.stages.size(), 2u);
      EXPECT_EQ(design.stages[0].kind == DesignStage::Kind::second_high, damping < 0.3);
      for (DesignStage& stage : design.stages) stage.divisor = divisor;
      const StageFactorTable table(target);
      EXPECT_NEAR(std::abs(DesignResponse(design, table).output(0)), std::norm(right) / std::norm(p), 1e-6);
    }
  }
}

}  // namespace
}  // namespace bodesmith::fpaa
