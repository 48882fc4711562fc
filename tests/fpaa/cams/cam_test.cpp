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
#include "signal/csv.hpp"

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
      EXPECT_TRUE(in_cab.fits_in(kPerCab)) << cam->name();
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
  const double dc = SwitchedBoard(plan).sampled({0.0}).real();
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

/// What the vendor's table, its menu and the picture have of a CAM.
TEST(CamLibrary, SaysAPlacedCamAsTheVendorDoes) {
  PlacedCam biquad;
  biquad.cam = cam_registry().find("FilterBiquad");
  biquad.capacitors = {{"C1", 9}, {"CA", 300}, {"CB", 20}};
  std::vector<std::string> listed;
  const auto list = [&](const PlacedCam& cam, const std::vector<std::string>& table) {
    listed.clear();
    for (const Capacitor& c : cam.cam->vendor_capacitors(cam, table))
      listed.push_back(c.name + "=" + std::to_string(c.units));
    return listed;
  };
  EXPECT_EQ(list(biquad, {}), (std::vector<std::string>{"C1=9", "CA1=255", "CA2=45", "CB1=20", "CB2=0"}));
  PlacedCam gain;
  gain.cam = cam_registry().find("GainInv");
  gain.capacitors = {{"Cin", 30}, {"Cout", 12}};
  EXPECT_EQ(list(gain, {"Cin", "Cout", "aCout"}),
            (std::vector<std::string>{"Cin=30", "Cout=12", "aCout=12"}));
  for (const char* name : {"GainInv", "SumInv"}) EXPECT_TRUE(cam_registry().get(name).is_gain());
  EXPECT_FALSE(biquad.cam->is_gain());
  // Pairs of equal capacitors, up to three inputs.
  PlacedCam sum;
  sum.cam = cam_registry().find("SumInv");
  const auto in_menu = [&](std::size_t inputs, int static_units) {
    sum.z.numerators.resize(inputs);
    sum.capacitors = {{"Cout", 5}, {"aCout", 5}};
    for (std::size_t i = 1; i <= inputs; ++i) {
      sum.capacitors.push_back({"Cin" + std::to_string(i), 7});
      sum.capacitors.push_back({"aCin" + std::to_string(i), i == inputs ? static_units : 7});
    }
    return sum.cam->in_vendor_menu(sum);
  };
  EXPECT_TRUE(in_menu(2, 7));
  EXPECT_TRUE(in_menu(3, 7));
  EXPECT_FALSE(in_menu(3, 6));
  EXPECT_FALSE(in_menu(4, 7));
  const auto zrna = [&](const char* cam, const char* option) {
    PlacedCam placed;
    placed.option = option;
    return cam_registry().get(cam).zrna_module(placed).value().class_name;
  };
  EXPECT_EQ(zrna("FilterBiquad", "Low Pass"), "FilterBiquadLowpass");
  EXPECT_EQ(zrna("FilterBiquad", "Band Pass"), "FilterBiquadBandpass");
  EXPECT_EQ(zrna("FilterBiquad", "High Pass"), "FilterBiquadHighpass");
  EXPECT_EQ(zrna("FilterBilinear", "Low Pass"), "FilterLowpass");
  EXPECT_EQ(zrna("FilterBilinear", "High Pass"), "FilterHighpass");
  const struct {
    const char* cam;
    CamValues realised;
    const char* drawn;
  } pictures[] = {{"FilterBilinear", {{"corner_hz", 1234.0}}, "corner 1.234 kHz"},
                  {"FilterBiquad", {{"corner_hz", 1234.0}}, "corner 1.234 kHz"},
                  {"GainInv", {{"gain", 1.23456}}, "gain 1.235"},
                  {"GainHold", {{"gain", -2.0}}, "gain -2, held"},
                  {"SumInv", {{"gain_1", 0.5}, {"gain_2", 2.0}}, "gains 0.5 2"},
                  {"SumDiff", {{"gain_1", -1.5}, {"gain_2", 0.8}}, "gains -1.5, 0.8"},
                  {"Comparator", {}, "sign of its input"},
                  {"GainSwitch", {}, "one of two, by a comparator"}};
  for (const auto& one : pictures) {
    PlacedCam placed;
    placed.realised = one.realised;
    placed.option = "Low Pass";
    placed.z.numerators.resize(2);
    EXPECT_EQ(cam_registry().get(one.cam).picture_text(placed), one.drawn) << one.cam;
  }
}

TEST(TransferFunction, ItsTableIsALineAnEntry) {
  LookupTable table;
  table.cout = 10;
  table.bytes[3] = 138;
  const Csv csv = Csv::parse(table.csv([](double v) { return 2.0 * v; }), "table.csv");
  ASSERT_EQ(csv.rows(), 256u);
  EXPECT_EQ(csv.column("entry")[3], 3.0);
  EXPECT_EQ(csv.column("output_v")[3], 2.0);
  EXPECT_EQ(csv.column("byte")[3], 138.0);
  EXPECT_NEAR(csv.column("wanted_v")[3], 2.0 * csv.column("input_v")[3], 1e-12);
}

}  // namespace
}  // namespace bodesmith::fpaa
