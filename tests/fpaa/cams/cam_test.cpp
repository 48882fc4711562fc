#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "base/error.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/cams/filter_stage.hpp"
#include "fpaa/cams/multiplier.hpp"
#include "fpaa/cams/transfer_function.hpp"
#include "fpaa/plan/plan.hpp"
#include "fpaa/plan/switched_board.hpp"
#include "fpaa/seed_sections.hpp"
#include "lti/frequency_grid.hpp"

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;

/// The denominators as the header has them, in x = 1/z: poles are inside the unit circle where both roots x are outside.
TEST(FilterStage, IsStableWhereItsPolesAreInsideTheCircle) {
  std::mt19937 draw(5);
  std::uniform_int_distribution<int> units(1, 60);
  for (const FilterStage::Kind kind : {FilterStage::Kind::second_low, FilterStage::Kind::second_high}) {
    int stable = 0;
    for (int i = 0; i < 400; ++i) {
      FilterStage stage{kind, {}};
      for (int k = 0; k < 8; ++k) stage.c.push_back(units(draw));
      const double c2 = stage.c[3], c3 = stage.c[4], c4 = stage.c[5], ca = stage.c[6], cb = stage.c[7];
      // p0 + p1 x + p2 x^2 of CA D (CB D + C4) + C2 C3 x, or of CA CB D^2 + C3 x (C2 + C4 D), D = 1 - x.
      const bool low = kind == FilterStage::Kind::second_low;
      const double p0 = ca * cb + (low ? ca * c4 : 0.0), p2 = ca * cb - (low ? 0.0 : c3 * c4);
      const double p1 = -2.0 * ca * cb + c2 * c3 + (low ? -ca * c4 : c3 * c4);
      if (p2 == 0.0) continue;
      const Complex root = std::sqrt(Complex(p1 * p1 - 4.0 * p0 * p2));
      const double least = std::min(std::abs((-p1 + root) / (2.0 * p2)), std::abs((-p1 - root) / (2.0 * p2)));
      if (std::abs(least - 1.0) < 1e-9) continue;
      EXPECT_EQ(stage.is_stable(), least > 1.0) << i << (low ? " low" : " high");
      stable += least > 1.0 ? 1 : 0;
    }
    EXPECT_GT(stable, 40);
    EXPECT_LT(stable, 390);
  }
}

TEST(CamLibrary, EveryCamFitsInACabOrSaysThatItsResourcesAreUnknown) {
  std::set<std::string_view> names;
  for (const Cam* cam : cam_registry().all()) {
    EXPECT_TRUE(names.insert(cam->name()).second);
    EXPECT_EQ(&cam_registry().get(cam->name()), cam);
    const CamFacts& facts = cam->facts();
    if (facts.resources) {
      Resources in_cab = *facts.resources;
      in_cab.lookup_tables = 0;
      EXPECT_TRUE(in_cab.fits_in(an231k04_quad4().per_cab)) << cam->name();
    }
  }
  EXPECT_GE(names.size(), 14u);
  EXPECT_THROW(cam_registry().get("FilterMagic"), InputError);
}

/// The switched-capacitor loop, charge by charge, driven by a sine: an oracle for the closed forms of the
/// header.
Complex simulated(const FilterStage& stage, double w_per_clock) {
  const bool high_q = stage.kind == FilterStage::Kind::second_high;
  const auto c = [&](FilterStage::Second which) { return stage.c[which]; };
  using enum FilterStage::Second;
  double v1 = 0.0, v2 = 0.0, before = 0.0;
  Complex sum = 0.0, reference = 0.0;
  const int settle = 60000, count = static_cast<int>(std::lround(400.0 * 2.0 * M_PI / w_per_clock));
  for (int n = 0; n < settle + count; ++n) {
    const double in = std::cos(w_per_clock * n);
    // Second integrator: C3 brings the first one's last output; C4 discharges it (low Q).
    double charge = c(kCB) * v2 + c(kC3) * v1 - c(kCpp) * (in - before);
    if (!high_q) charge -= c(kCp) * in;
    const double v2_next = charge / (high_q ? c(kCB) : c(kCB) + c(kC4));
    double v1_charge = c(kCA) * v1 - c(kC1) * in - c(kC2) * v2_next;
    if (high_q) v1_charge -= c(kC4) * (v2_next - v2) + c(kCp) * (in - before);
    v1 = v1_charge / c(kCA);
    v2 = v2_next;
    before = in;
    if (n >= settle) {
      sum += v2 * std::polar(1.0, -w_per_clock * n);
      reference += in * std::polar(1.0, -w_per_clock * n);
    }
  }
  return sum / reference;
}

TEST(FilterBiquad, TransferIsWhatTheChargesDo) {
  using enum FilterStage::Kind;
  for (const std::size_t input : {0u, 1u, 2u}) {
    for (const bool high_q : {false, true}) {
      FilterStage stage{high_q ? second_high : second_low, {0, 0, 0, 15, 17, high_q ? 60.0 : 12.0, 150, 160}};
      stage.c[input] = 20;
      for (const double w : {0.05, 0.1, 0.3}) {
        const Complex closed = stage.transfer().response({w}, {1.0});
        // The second integrator samples V1 of the period before: both forms carry that 1/z in C3.
        EXPECT_NEAR(std::abs(simulated(stage, w) - closed), 0.0, 0.02 * std::abs(closed) + 1e-4)
            << input << high_q << " " << w;
      }
    }
  }
}

TEST(FilterBiquad, ComplexSectionsGoOnTheBoard) {
  Sections sections;
  Section resonant;
  const double w = 2.0 * M_PI * 1000.0;
  resonant.gain = 0.5 * w * w;
  resonant.poles = {Complex(-0.3 * w, w * std::sqrt(1 - 0.09)), Complex(-0.3 * w, -w * std::sqrt(1 - 0.09))};
  sections.sections = {resonant, Section::pole_zero(1.0, {w}, {0.7 * w})};
  PlanOptions options;
  options.band = Band{{20.0}, {1500.0}};
  options.topology = PlanOptions::Topology::chain;
  const Plan plan = plan_of(sections, options);
  EXPECT_EQ(plan.cams()[0]->cam_name(), "FilterBiquad");
  EXPECT_EQ(plan.cams()[0]->resources.opamps, 2);
  // Half a period of the clock is in 1/z of the low pass: the error falls with the clock.
  EXPECT_LT(plan.error.max_complex_percent, 8.0);
  const double dc = plan_response(plan, {0.0}, false).real();
  EXPECT_NEAR(dc, 0.5, 0.02);

  sections.sections[0].zeros = {-100.0};
  EXPECT_NE(refusal_of(make_plan(sections, options)), nullptr);
}

TEST(Multiplier, QuantisesWithinHalfAStep) {
  for (double y = -2.99; y < 2.99; y += 0.01)
    EXPECT_LE(std::abs(Multiplier::quantised(y) - y), 3.0 / 256.0 + 1e-12);
}

TEST(TransferFunction, TableFollowsTheFunctionWithinOneStep) {
  const auto d = [](double v) { return 0.3546 * v - 0.6433 * v * v / 3.0; };
  const LookupTable table = value_or_throw(LookupTable::of(d));
  double step = 2.0 / table.cout;
  for (std::size_t entry = 0; entry < 256; ++entry) {
    const double wanted = std::clamp(d(LookupTable::input_v(entry)), -3.0, 3.0);
    EXPECT_LE(std::abs(table.output_v(entry) - wanted), 0.5 * step + 1e-9) << entry;
    EXPECT_EQ(LookupTable::entry_of(LookupTable::input_v(entry)), entry);
  }
  EXPECT_NE(refusal_of(LookupTable::of([](double) { return 0.0; })), nullptr);
  EXPECT_NE(refusal_of(LookupTable::of([](double v) { return 1.0 / (v - v); })), nullptr);
}

}  // namespace
}  // namespace bodesmith::fpaa
