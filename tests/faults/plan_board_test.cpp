// An FPAA board: a wrong capacitor, a wrong clock, a good one; the truth by charge conservation.
#include <gtest/gtest.h>

#include <algorithm>

#include "base/error.hpp"
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
  const std::vector<Hertz> grid = log_grid({Hertz{10.0}, Hertz{1500.0}}, 20);
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

TEST(PlanBoard, OnlyTheOutputCanBeMeasured) {
  const std::vector<Hertz> grid = log_grid({Hertz{10.0}, Hertz{1500.0}}, 8);
  Measurement measurement;
  measurement.channels.push_back(seen(grid, std::vector<std::complex<double>>(8, 1.0), 1));
  measurement.channels[0].node = "n1";
  EXPECT_THROW(PlanBoard(small_plan(), measurement, Spread()), InputError);
}

}  // namespace
}  // namespace bodesmith::faults
