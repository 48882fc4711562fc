// Two processors make figures that differ in their last digits: they should find the same plan.
#include <gtest/gtest.h>

#include <cmath>

#include "fpaa/seed_sections.hpp"

namespace bodesmith::fpaa {
namespace {

/// Gain and roots off by up to 1e-13 of themselves; conjugate and equal ones alike.
Sections a_little_off(Sections sections, int seed) {
  const auto off = [&](double of) { return 1.0 + 1e-13 * std::sin(1e3 * std::log(of) + seed); };
  for (Section& section : sections.sections) {
    section.gain *= off(std::abs(section.gain) + 1.0);
    for (auto* roots : {&section.zeros, &section.poles}) {
      for (auto& root : *roots) root *= root == 0.0 ? 1.0 : off(std::abs(root));
    }
  }
  return sections;
}

/// Every CAM, clock and capacitor.
std::vector<std::string> built(const Plan& plan) {
  std::vector<std::string> out;
  for (const PlacedCam* cam : plan.cams()) {
    std::string line = std::string(cam->cam_name()) + " " + std::to_string(cam->clock_a.value);
    for (const Capacitor& c : cam->capacitors) line += " " + c.name + std::to_string(c.units);
    out.push_back(std::move(line));
  }
  return out;
}

std::vector<std::complex<double>> resonance(double hz, double quality) {
  const double w = 2.0 * M_PI * hz;
  const std::complex<double> p(-0.5 * w / quality, w * std::sqrt(1.0 - 0.25 / (quality * quality)));
  return {p, std::conj(p)};
}

TEST(LastBits, DecideNoPartOfAPlan) {
  Sections low, high, all_pass;
  const double w = 2.0 * M_PI * 1000.0;
  low.sections = {{w * w, {}, resonance(1000.0, 0.7)}, {0.5 * w, {}, {-0.5 * w}}};
  high.sections = {{1.0, {0.0, 0.0}, resonance(20.0, 1.0)}};
  all_pass.sections = {{-1.0, {w}, {-w}}};
  const struct {
    Sections sections;
    Band band;
  } cases[] = {{seed_sections(), {{1.0}, {100.0}}},
               {low, {{50.0}, {3000.0}}},
               {high, {{5.0}, {200.0}}},
               {all_pass, {{10.0}, {10e3}}}};
  for (const auto& one : cases) {
    PlanOptions options;
    options.band = one.band;
    const std::vector<std::string> wanted = built(plan_of(one.sections, options));
    EXPECT_EQ(built(plan_of(a_little_off(one.sections, 1), options)), wanted) << one.band.to.value;
  }
}

}  // namespace
}  // namespace bodesmith::fpaa
