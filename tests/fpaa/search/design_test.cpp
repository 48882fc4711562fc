// What scales of a design leave as it is, and where a design is judged.
#include "fpaa/search/design.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fpaa/plan/error_reference.hpp"
#include "fpaa/plan/plan_limits.hpp"
#include "fpaa/plan/switched_board.hpp"
#include "fpaa/search/score.hpp"
#include "fpaa/search/target.hpp"
#include "fpaa/search/whole_capacitors.hpp"
#include "lti/section_making.hpp"

namespace bodesmith::fpaa {
namespace {

using Stage = DesignStage;

/// Both forms of second order, then a sum of the second stage and the board's input at half the clock.
Design three_stages() {
  Design out;
  Stage low;
  low.kind = FilterStage::Kind::second_low;
  low.divisor = 10;
  low.from = {Stage::kBoardInput};
  low.c = {30, 5, 11, 40, 70, 60, 200, 180};
  Stage high = low;
  high.kind = FilterStage::Kind::second_high;
  high.from = {0};
  high.c = {90, 12, 7, 35, 50, 30, 150, 190};
  Stage sum;
  sum.divisor = 20;
  sum.from = {1, Stage::kBoardInput};
  sum.c = {20, 31, 14, 9, 50, 77};
  out.stages = {low, high, sum};
  return out;
}

DesignTarget some_target() {
  DesignTarget out;
  out.master_hz = 1e6;
  out.band = {{10.0}, {2000.0}};
  for (const Hertz f : log_grid(out.band, 25)) {
    out.grid.push_back(f.rad_s());
    out.wanted.emplace_back(-1.0);
    out.weight.push_back(1.0);
    out.reciprocal.push_back(1.0);
  }
  return out;
}

std::vector<Complex> pin_of(const Design& design, const StageFactorTable& table) {
  const DesignResponse response(design, table);
  std::vector<Complex> out;
  for (std::size_t k = 0; k < table.points(); ++k) out.push_back(response.output(k));
  return out;
}

void expect_same_pin(const std::vector<Complex>& a, const std::vector<Complex>& b, Complex factor = 1.0) {
  for (std::size_t k = 0; k < a.size(); ++k) EXPECT_LT(std::abs(b[k] / (factor * a[k]) - 1.0), 1e-11) << k;
}

TEST(Design, ScalesOfNodesAndGroupsLeaveTheResponse) {
  const DesignTarget target = some_target();
  const StageFactorTable table(target);
  const Design design = three_stages();
  const std::vector<Complex> pin = pin_of(design, table);
  EXPECT_EQ(design.opamps(), 5);
  for (const std::size_t stage : {0u, 1u}) {
    Design scaled = design;
    scaled.scale_node(stage, 1.7);
    const DesignResponse was(design, table), is(scaled, table);
    for (std::size_t k = 0; k < table.pairs(); ++k)
      EXPECT_LT(std::abs(is.signal(stage, k).end1.at(0) / was.signal(stage, k).end1.at(0) - 1.7), 1e-11);
    expect_same_pin(pin, pin_of(scaled, table));
  }
  Design louder = design;
  louder.scale_node(2, 3.0);
  expect_same_pin(pin, pin_of(louder, table), 3.0);
  for (std::size_t s = 0; s < 3; ++s) {
    const auto groups = scale_groups(design.stages[s]);
    std::vector<std::size_t> all;
    for (const auto& group : groups) {
      Design scaled = design;
      for (const std::size_t c : group) scaled.stages[s].c[c] *= 0.6;
      expect_same_pin(pin, pin_of(scaled, table));
      all.insert(all.end(), group.begin(), group.end());
    }
    std::ranges::sort(all);
    for (std::size_t c = 0; c < design.stages[s].c.size(); ++c) EXPECT_EQ(all.at(c), c);
  }
}

TEST(Design, NodesStandOnTheGeometricWayOnceScaled) {
  const DesignTarget target = some_target();
  const StageFactorTable table(target);
  Design design = three_stages();
  const std::vector<Complex> pin = pin_of(design, table);
  const std::vector<NodePeak> before = node_peaks(DesignResponse(design, table));
  scale_nodes(design, table);
  expect_same_pin(pin, pin_of(design, table));
  const std::vector<NodePeak> after = node_peaks(DesignResponse(design, table));
  const double end = before.back().output;
  EXPECT_NEAR(after.back().output, end, 1e-9 * end);
  for (std::size_t s = 0; s < 2; ++s) {
    const double wanted = std::pow(end, static_cast<double>(s + 1) / 3.0);
    const double input = std::pow(end, static_cast<double>(s) / 3.0);
    EXPECT_NEAR(after[s].output / wanted, 1.0, 1e-9) << s;
    EXPECT_NEAR(after[s].inner / std::max(input, wanted), 1.0, 1e-9) << s;
  }
  EXPECT_EQ(after[2].inner, 0.0);
  // A last stage of second order has its inner node so as well.
  Design two = three_stages();
  two.stages.pop_back();
  scale_nodes(two, table);
  const NodePeak last = node_peaks(DesignResponse(two, table)).back();
  const double of_two = std::max(last.output, std::sqrt(last.output));
  EXPECT_NEAR(last.inner / of_two, 1.0, 1e-9);
}

TEST(Design, WhatTheFitMoves) {
  Design design = three_stages();
  const auto free_of = [](const Stage& stage) {
    std::vector<std::size_t> out;
    for (std::size_t c = 0; c < stage.c.size(); ++c)
      if (stage.is_free(c)) out.push_back(c);
    return out;
  };
  EXPECT_EQ(free_of(design.stages[0]),
            (std::vector<std::size_t>{Stage::kC1, Stage::kCp, Stage::kCpp, Stage::kC2, Stage::kC4}));
  EXPECT_EQ(free_of(design.stages[2]), (std::vector<std::size_t>{0, 1, 2, 3, 5}));
  design.stages[2].c[1] = 0.0;
  EXPECT_EQ(free_of(design.stages[2]), (std::vector<std::size_t>{0, 2, 3, 5}));
  design.stages[2].whole = true;
  EXPECT_TRUE(free_of(design.stages[2]).empty());
}

TEST(Design, SnappedNumbersDifferByAMillionth) {
  for (const double x : {1.0, -3.25, 1e-9, 7.7e12, 0.0}) {
    EXPECT_LE(std::abs(snapped(x) - x), std::abs(x) * std::exp2(-20));
    EXPECT_EQ(snapped(snapped(x)), snapped(x));
    EXPECT_EQ(snapped(x * (1.0 + 1e-12)), snapped(x));
  }
  EXPECT_NE(snapped(1.0 + 4e-6), snapped(1.0));
}

TEST(DesignTarget, PointsOverTheBandAndAFewBeyond) {
  const Sections sections = make_sections(1e6, {Complex(0, 3e3), Complex(0, -3e3)}, {-2e3, -3e3, -4e3});
  const Board& board = an231k04_quad4();
  const Band band{{10.0}, {5000.0}};
  const DesignTarget target = design_target(sections, band, 40.0, board);
  EXPECT_EQ(target.master_hz, board.master_clock.value);
  const std::vector<Hertz> sharp = about_sharp_roots(sections, band);
  ASSERT_EQ(target.grid.size(), 107u + sharp.size() + 8u);  // 40 of 2.7 decades
  EXPECT_NEAR(target.grid.front().value, band.from.rad_s().value, 1e-9);
  EXPECT_NEAR(target.grid[106].value, band.to.rad_s().value, 1e-7);
  double peak = 0.0;
  for (std::size_t k = 0; k < 107; ++k) peak = std::max(peak, std::abs(target.wanted[k]));
  for (std::size_t k = 0; k < target.grid.size(); ++k) {
    const bool beyond = k >= target.grid.size() - 8;
    EXPECT_EQ(target.weight[k], beyond ? 0.1 : 1.0);
    EXPECT_EQ(target.wanted[k], sections.response(target.grid[k]));
    const double f = target.grid[k].hz().value;
    EXPECT_TRUE(beyond ? f > 5700.0 && f < 20001.0 : f < 5001.0) << f;
    EXPECT_NEAR(1.0 / target.reciprocal[k], std::max(error_reference(sections, target.grid[k]), 1e-5 * peak),
                1e-9 * peak);
  }
  EXPECT_EQ(design_target(make_sections(1.0, {}, {-2e3}), {{100.0}, {110.0}}, 40.0, board).grid.size(), 38u);
}

TEST(DesignTarget, ClocksWithinTheBandAreSeenAtTheirMultiples) {
  const Sections sections = make_sections(1.0, {}, {-2e3});
  DesignTarget target = design_target(sections, {{10.0}, {50e3}}, 20.0, an231k04_quad4());
  target.master_hz = 1e6;
  Design design;
  Stage slow;
  slow.divisor = 50;  // 20 kHz, a pole at 200 rad/s
  slow.from = {Stage::kBoardInput};
  slow.c = {2, 0, 2, 200};
  Stage wide = slow;
  wide.divisor = 100;
  wide.c = {200, 0, 200, 20};  // its corner lies above a sixth of its clock
  design.stages = {slow, wide};
  EXPECT_NEAR(corner_of(slow, 1e6), 200.0, 1e-9);
  EXPECT_NEAR(corner_of(wide, 1e6), 1e5, 1e-6);
  slow.c[3] = 0.0;
  EXPECT_NEAR(corner_of(slow, 1e6), 2e7, 1e-3);
  Stage second = three_stages().stages[0];
  EXPECT_NEAR(corner_of(second, 1e6), 1e5 * std::sqrt(40.0 * 70.0 / (200.0 * 180.0)), 1e-6);
  const DesignTarget more = with_clocks_seen(target, design, sections);
  ASSERT_EQ(more.grid.size(), target.grid.size() + 16u);  // around 20 and 40 kHz
  const double width = 200.0 / (2.0 * std::numbers::pi);
  EXPECT_NEAR(more.grid[target.grid.size()].hz().value, 20e3 - 10.0 * width, 1e-6);
  EXPECT_NEAR(more.grid.back().hz().value, 40e3 + 10.0 * width, 1e-6);
  // None counts for more than what counts most already.
  const double most = *std::ranges::max_element(target.reciprocal);
  for (std::size_t k = target.grid.size(); k < more.grid.size(); ++k) {
    EXPECT_EQ(more.weight[k], 1.0);
    EXPECT_NEAR(more.reciprocal[k] / std::min(1.0 / error_reference(sections, more.grid[k]), most), 1.0,
                1e-12);
  }
}

TEST(DesignScore, ImagesOfADesignAreThoseOfItsPlan) {
  // A slow low pass at 2 kHz on top of a fast one: the beat beside each multiple of 2 kHz is as wide as its pole.
  Design design;
  Stage fast;
  fast.name = "Fast";
  fast.divisor = 400;
  fast.from = {Stage::kBoardInput};
  fast.c = {20, 0, 20, 90};
  Stage slow = fast;
  slow.name = "Slow";
  slow.divisor = 8000;
  slow.from = {0};
  slow.c = {5, 3, 5, 200};
  design.stages = {fast, slow};
  const Board board = an231k04_quad4();
  const Sections sections = make_sections(1.0, {-300.0}, {-50.0});
  const DesignTarget target = design_target(sections, {{3.0}, {5000.0}}, 40.0, board);
  const Plan plan = value_or_throw(plan_of_design(design, board));
  const ImageLines images = images_of(SwitchedBoard(plan), plan, target.band);
  double squares = 0.0;
  for (const ImageLines::Sine& sine : images.sines) {
    squares +=
        sine.signal.share * std::pow(sine.rms / error_reference(sections, sine.signal.frequency.rad_s()), 2);
  }
  EXPECT_GT(squares, 1e-5);
  EXPECT_NEAR(image_share(design, target) / std::sqrt(squares), 1.0, 0.03);
}

}  // namespace
}  // namespace bodesmith::fpaa
