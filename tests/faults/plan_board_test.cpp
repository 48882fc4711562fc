// An FPAA board: a wrong capacitor, a wrong clock, a good one; the truth by charge conservation.
#include <gtest/gtest.h>

#include <algorithm>

#include "base/error.hpp"
#include "base/text.hpp"
#include "circuits.hpp"
#include "faults/diagnosis.hpp"
#include "faults/plan_board.hpp"
#include "fpaa/plan/switched_board.hpp"
#include "fpaa/trim/trim.hpp"

namespace bodesmith::faults {
namespace {

const fpaa::Plan& small_plan() {
  static const fpaa::Plan plan = [] {
    Sections sections;
    for (const auto& [zero, pole] : {std::pair(-300.0, -500.0), std::pair(-2500.0, -1500.0)}) {
      Section one;
      one.gain = 1.0;
      one.zeros = {zero};
      one.poles = {pole};
      sections.sections.push_back(one);
    }
    fpaa::PlanOptions options;
    options.topology = fpaa::PlanOptions::Topology::chain;
    return value_or_throw(fpaa::make_plan(sections, options));
  }();
  return plan;
}

Diagnosis diagnosed_plan(const fpaa::Plan& built, std::uint64_t seed) {
  const std::vector<Hertz> grid = log_grid({Hertz{10.0}, Hertz{1500.0}}, 12);
  const fpaa::SwitchedBoard exact(built);
  std::vector<std::complex<double>> response;
  for (const Hertz f : grid) response.push_back(exact.gain(f.rad_s()));
  Measurement measurement;
  measurement.channels.push_back(seen(grid, response, seed, true, 1e-3));
  const PlanBoard board(small_plan(), measurement, Spread());
  return diagnose_board(board, DiagnosisOptions());
}

bool accused(const Diagnosis& d, const std::string& part) {
  return std::any_of(d.suspects.begin(), d.suspects.begin() + static_cast<std::ptrdiff_t>(d.tied),
                     [&](const Suspect& s) { return s.site.find(part) != std::string::npos; });
}

TEST(PlanBoard, AGoodBoardIsNotAccused) {
  EXPECT_EQ(diagnosed_plan(small_plan(), 3).verdict, Verdict::nothing_wrong);
}

TEST(PlanBoard, AWrongCapacitorIsNamedOrTied) {
  std::vector<int> units;
  std::vector<std::string> names;
  for (const fpaa::ChipPlan& chip : small_plan().chips) {
    for (const fpaa::PlacedCam& cam : chip.cams) {
      for (const fpaa::Capacitor& c : cam.capacitors) {
        units.push_back(c.units);
        names.push_back("chip" + std::to_string(chip.chip) + "." + cam.name + "." + c.name);
      }
    }
  }
  for (const std::size_t i : {std::size_t{0}, units.size() - 1}) {
    std::vector<int> wrong = units;
    wrong[i] = std::max(1, wrong[i] ^ 16);  // one bit
    const Diagnosis d = diagnosed_plan(fpaa::with_capacitors(small_plan(), wrong), 4);
    EXPECT_TRUE(d.verdict == Verdict::one_fault || d.verdict == Verdict::tie) << names[i];
    EXPECT_TRUE(accused(d, names[i])) << names[i];
  }
}

/// A capacitor of each of two CAMs.
TEST(PlanBoard, TwoWrongCamsAreBothAccused) {
  std::vector<int> units;
  std::vector<std::string> cams;
  std::vector<std::string> names;
  for (const fpaa::ChipPlan& chip : small_plan().chips) {
    for (const fpaa::PlacedCam& cam : chip.cams) {
      for (const fpaa::Capacitor& c : cam.capacitors) {
        units.push_back(c.units);
        cams.push_back(cam.name);
        names.push_back("chip" + std::to_string(chip.chip) + "." + cam.name + "." + c.name);
      }
    }
  }
  ASSERT_NE(cams.front(), cams.back());
  std::vector<int> wrong = units;
  wrong.front() = std::max(1, wrong.front() ^ 32);
  wrong.back() = std::max(1, wrong.back() ^ 64);
  const Diagnosis d = diagnosed_plan(fpaa::with_capacitors(small_plan(), wrong), 6);
  EXPECT_TRUE(d.verdict == Verdict::two_faults || d.verdict == Verdict::tie);
  EXPECT_TRUE(std::any_of(d.suspects.begin(), d.suspects.begin() + static_cast<std::ptrdiff_t>(d.tied),
                          [&](const Suspect& s) {
                            return s.site.find(cams.front()) != std::string::npos &&
                                   s.site.find(cams.back()) != std::string::npos;
                          }))
      << d.suspects[0].site << " of " << names.front() << " and " << names.back();
}

TEST(PlanBoard, AWrongClockIsNamed) {
  fpaa::Plan built = small_plan();
  fpaa::PlacedCam& cam = built.chips[0].cams[0];
  cam.clock_a.value *= 0.5;
  const Diagnosis d = diagnosed_plan(built, 5);
  EXPECT_TRUE(accused(d, cam.name)) << d.suspects[0].site;
}

PlanBoard unmeasured(const std::vector<Hertz>& grid, const Spread& spread = Spread()) {
  Measurement measurement;
  measurement.channels.push_back(seen(grid, std::vector<std::complex<double>>(grid.size(), 1.0), 1));
  return {small_plan(), measurement, spread};
}

TEST(PlanBoard, WhatAFaultSaysIsWhatItDoes) {
  const std::vector<Hertz> grid = log_grid({Hertz{10.0}, Hertz{1500.0}}, 6);
  const PlanBoard board = unmeasured(grid);
  std::size_t capacitors = 0, clocks = 0;
  for (const Fault& fault : board.faults()) {
    for (const double t : {fault.from, 0.5 * (fault.from + fault.to), fault.to}) {
      const FaultSize size = fault.size(t);
      const Effect effect = fault.effect(t);
      if (size.key == "value_units") {
        ASSERT_EQ(effect.units.size(), 1u);
        const auto& [at, units] = effect.units[0];
        EXPECT_EQ(fault.parts, std::vector{board.capacitors()[at]});
        EXPECT_EQ(fault.replaces, std::vector{at});
        EXPECT_EQ(units, size.value);
        EXPECT_NE(fault.words(t).find(" has " + rounded_text(units, 3) + " units instead of "),
                  std::string::npos);
        // From a unit or so, or a share, to as many as a bank has: either way.
        EXPECT_GE(std::abs(units - board.units()[at]), 0.5);
        EXPECT_LE(std::abs(std::log(units / board.units()[at])), std::log(1000.0));
        ++capacitors;
      } else if (size.key == "clock_hz") {
        ASSERT_FALSE(effect.clocks.empty());
        for (const auto& [cam, factor] : effect.clocks)
          EXPECT_NEAR(board.graph().nodes[cam].cam->clock_a.value * factor, size.value, 1e-9 * size.value);
        EXPECT_NE(fault.words(t).find(engineering_text(size.value, "Hz", 4)), std::string::npos);
        ++clocks;
      } else {
        EXPECT_FALSE(fault.has_size());
        for (std::size_t i = 0; i < effect.units.size(); ++i) {
          const double other = board.units()[effect.units[effect.units.size() - 1 - i].first];
          EXPECT_NEAR(effect.units[i].second, effect.units.size() == 1 ? 0.0 : other, 1e-3) << fault.words(t);
        }
      }
    }
  }
  EXPECT_GE(capacitors, 6 * board.units().size() / 2);
  EXPECT_GT(clocks, 0u);
}

/// d ln H for one standard deviation of each capacitor, which is `unit_capacitor_percent`/sqrt(units).
TEST(PlanBoard, SlopesAreThoseOfOneStandardDeviation) {
  const std::vector<Hertz> grid = log_grid({Hertz{10.0}, Hertz{1500.0}}, 6);
  const PlanBoard board = unmeasured(grid);
  const Prediction good = board.predict({});
  ASSERT_EQ(board.unknowns(), board.units().size());
  for (std::size_t c = 0; c < board.unknowns(); ++c) {
    const double units = board.units()[c];
    ASSERT_GT(units, 0.0);
    const double step = 1e-4;
    Effect more, less;
    more.units = {{c, units * (1.0 + step)}};
    less.units = {{c, units * (1.0 - step)}};
    const double sigma = 0.01 * Spread().mismatch.unit_percent / std::sqrt(units);
    const Eigen::VectorXcd up = board.response(more), down = board.response(less);
    for (Eigen::Index k = 0; k < up.size(); ++k)
      EXPECT_LT(std::abs(std::log(up(k) / down(k)) / (2.0 * step) * sigma -
                         good.slopes(k, static_cast<Eigen::Index>(c))),
                1e-4 * sigma)
          << board.capacitors()[c];
  }
}

TEST(PlanBoard, WhatEveryCapacitorHasTooMuchIsNoFault) {
  const std::vector<Hertz> grid = log_grid({Hertz{10.0}, Hertz{1500.0}}, 6);
  Spread spread;
  spread.mismatch.systematic_units = 0.25;
  const fpaa::DrawnBoard drawn(small_plan(), grid);
  std::vector<double> units = drawn.nominal_units();
  for (double& n : units) n += 0.25;
  const std::vector<Complex> built = drawn.response(units);
  const PlanBoard board = unmeasured(grid, spread);
  const PlanBoard without = unmeasured(grid);
  for (std::size_t k = 0; k < grid.size(); ++k) {
    const Complex truth = built[k];
    const auto at = static_cast<Eigen::Index>(k);
    EXPECT_LT(std::abs(board.good_response()(at) - truth), 1e-9 * std::abs(truth));
    EXPECT_GT(std::abs(without.good_response()(at) - truth), 1e-5 * std::abs(truth));
  }
}

TEST(PlanBoard, OnlyTheOutputCanBeMeasured) {
  const std::vector<Hertz> grid = log_grid({Hertz{10.0}, Hertz{1500.0}}, 8);
  Measurement measurement;
  measurement.channels.push_back(seen(grid, std::vector<std::complex<double>>(8, 1.0), 1));
  measurement.channels[0].node = "n1";
  EXPECT_THROW(PlanBoard(small_plan(), measurement, Spread()), InputError);
}

}  // namespace
}  // namespace bodesmith::faults
