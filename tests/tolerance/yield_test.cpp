#include "tolerance/yield.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "kept_text.hpp"
#include "lti/frequency_grid.hpp"
#include "lti/judge_responses.hpp"
#include "numeric/random.hpp"
#include "schematic/analysis/response.hpp"
#include "synthesis/realise.hpp"
#include "synthesis/seed_sections.hpp"
#include "temporary_folder.hpp"
#include "tolerance/counts.hpp"
#include "tolerance/kernel.hpp"

namespace bodesmith::tolerance {
namespace {

Options small(std::uint64_t samples = 20000) {
  Options options;
  options.samples = samples;
  options.grid = log_grid({Hertz{1}, Hertz{100}}, 20);
  return options;
}

Design seed_design() {
  return design_of_circuit(synthesis::realise(seed_sections()).circuit, seed_sections(), "seed",
                           OpAmps::ideal);
}

// Ladders have no quadratics: they are evaluated one by one, and agree with the sections they were made from.
TEST(Yield, LaddersAndBuiltCircuitsAreJudgedAsTheyAre) {
  synthesis::RealiseOptions ladder;
  ladder.realisation = "foster1";
  ladder.limits = {100.0, 10e6, 47e-12, 4.7e-6};
  const synthesis::Realised made = synthesis::realise(seed_sections(), ladder);
  const Design ideal = design_of_circuit(made.circuit, seed_sections(), "ladder", OpAmps::ideal);
  EXPECT_FALSE(ideal.is_quick());
  Options options = small(200);
  options.spread.resistor_percent = options.spread.capacitor_percent = 1e-9;
  const Result exact = run_monte_carlo(ideal, options, Team());
  EXPECT_NEAR(exact.worst_db.max, made.report.parts.max_magnitude_db, 0.05);
  options.spread = {};
  const Result spread = run_monte_carlo(ideal, options, Team());
  EXPECT_GT(spread.worst_db.quantile(0.5), 0.02);
  EXPECT_EQ(spread.samples, 200u);
  // The op-amps' own error counts where the circuit is taken as built.
  const Design built = design_of_circuit(made.circuit, seed_sections(), "ladder", OpAmps::as_built);
  const Hertz high{1e5};
  EXPECT_NEAR(std::abs(built.nominal(high) / built.reference(high)),
              std::abs(schematic::network_response(made.circuit, {high}).front() /
                       seed_sections().response(high.rad_s())),
              1e-9);
}

std::string text_of(const Result& result, const Options& options) {
  return to_text(to_json(result, options));
}

// Known answers of Random123's kat_vectors for philox4x32-10.
TEST(Random, PhiloxKnownAnswers) {
  EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}),
            (std::array<std::uint32_t, 4>{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(philox({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}),
            (std::array<std::uint32_t, 4>{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (std::array<std::uint32_t, 4>{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(Random, NormalQuantileInvertsTheDistribution) {
  for (const double p : {1e-12, 1e-6, 0.01, 0.3, 0.5, 0.7, 0.925, 0.99, 1.0 - 1e-6}) {
    const double z = normal_quantile(p);
    EXPECT_NEAR(0.5 * std::erfc(-z / std::sqrt(2.0)) / p, 1.0, 1e-12) << p;
  }
  EXPECT_NEAR(normal_quantile(0.975), 1.959963984540054, 1e-14);
}

/// -R2/R1 with R2 first.
std::shared_ptr<const schematic::Netlist> inverter() {
  schematic::Netlist out;
  schematic::Part r2, r1;
  r2.name = "R2";
  r2.from = "m";
  r2.to = "out";
  r1.name = "R1";
  r1.from = "in";
  r1.to = "m";
  r1.realised = r2.realised = 1000.0;
  out.parts = {r2, r1};
  out.opamps = {{"U1", "", 0, "0", "m", "out"}};
  return std::make_shared<const schematic::Netlist>(out);
}

// One resistor divider-like stage whose distribution is known: an inverter -R2/R1 with only R2 spread.
TEST(Yield, UniformSpreadOfOneResistorIsItsDistribution) {
  Design design;
  design.name = "gain";
  design.parts = {{"R2", Part::Kind::resistor, 1000.0}};
  design.netlist = inverter();
  design.stages = {
      {"s", 0, 1, [](std::span<const double> v) { return synthesis::Biquad{v[0] / 1000.0, 0, 0, 1, 0, 0}; }}};
  design.wanted = [](Hertz) { return std::complex<double>(1.0, 0.0); };
  Options options = small(200000);
  options.spread.resistor_percent = 10.0;
  options.limit_db = to_decibel(1.05);
  const Result result = run_monte_carlo(design, options, Team());
  for (const double p : {0.05, 0.25, 0.5, 0.75, 0.95}) {
    EXPECT_NEAR(result.magnitude_db[3].quantile(p), to_decibel(0.9 + 0.2 * p), 0.008);
  }
  // Histograms reach as far where the nominal circuit is half of what was wanted.
  Design half = design;
  half.wanted = [](Hertz) { return std::complex<double>(2.0, 0.0); };
  const Result far = run_monte_carlo(half, options, Team());
  for (const double p : {0.05, 0.5, 0.95})
    EXPECT_NEAR(far.magnitude_db[3].quantile(p), to_decibel(0.5 * (0.9 + 0.2 * p)), 0.04);
  // |20 log10 u| <= 20 log10 1.05: u between 1/1.05 and 1.05.
  EXPECT_NEAR(static_cast<double>(result.within) / 200000.0, (1.05 - 1.0 / 1.05) / 0.2, 0.004);
  options.spread.kind = Spread::Kind::gaussian;
  const Result normal = run_monte_carlo(design, options, Team());
  EXPECT_NEAR(normal.magnitude_db[0].quantile(0.8413447), to_decibel(1.0 + 0.1 / 3.0), 0.006);
  options.spread.kind = Spread::Kind::corners;
  const Result corners = run_monte_carlo(design, options, Team());
  EXPECT_NEAR(corners.worst_db.max, -to_decibel(0.9), 1e-9);
  EXPECT_NEAR(corners.worst_db.min, to_decibel(1.1), 1e-9);
}

// All six coefficients, none of them 1: without tolerances nothing is off.
TEST(Yield, AStageOfSecondOrderIsTheQuotientOfItsPolynomials) {
  Design design;
  design.name = "notch";
  design.parts = {{"R1", Part::Kind::resistor, 1000.0}};
  design.netlist = inverter();
  design.stages = {{"s", 0, 1, [](std::span<const double>) {
                      return synthesis::Biquad{3.0, 0.02, 4e-5, 2.0, 0.01, 5e-5};
                    }}};
  design.wanted = [](Hertz f) {
    const std::complex<double> s(0.0, f.rad_s().value);
    return (3.0 + 0.02 * s + 4e-5 * s * s) / (2.0 + 0.01 * s + 5e-5 * s * s);
  };
  Options options = small(100);
  options.spread.resistor_percent = options.spread.capacitor_percent = 0.0;
  const Result result = run_monte_carlo(design, options, Team());
  EXPECT_LT(result.worst_db.max, 1e-9);
  EXPECT_LT(result.worst_deg.max, 1e-9);
}

// The fast kernel against the plain complex product, sample by sample.
TEST(Yield, KernelAgreesWithThePlainResponse) {
  const Design design = seed_design();
  Options options = small();
  options.spread.resistor_percent = options.spread.capacitor_percent = 0.0;
  Kernel kernel(design, options);
  kernel.evaluate(0, 3);
  for (size_t i = 0; i < options.grid.size(); ++i) {
    const auto ratio = design.nominal(options.grid[i]) / design.reference(options.grid[i]);
    EXPECT_NEAR(kernel.decibel(i)[0], to_decibel(std::abs(ratio)), 1e-11);
    EXPECT_NEAR(kernel.degrees(i)[2], to_degrees(std::arg(ratio)), 1e-10);
  }
}

// Facts: 1 % R / 5 % C 1.68 dB, 1 % / 1 % 0.44 dB at the 95th percentile, for another choice of parts.
TEST(Yield, SeedSectionsLoseWhatTheFactsSay) {
  Options options = small();
  const Result wide = run_monte_carlo(seed_design(), options, Team());
  EXPECT_NEAR(wide.worst_db.quantile(0.95), 1.68, 0.12);
  options.spread.capacitor_percent = 1.0;
  EXPECT_NEAR(run_monte_carlo(seed_design(), options, Team()).worst_db.quantile(0.95), 0.44, 0.03);
  expect_kept("tolerance/kept_yield.txt", line_a_key(to_json(wide, small())));
  EXPECT_LE(wide.worst_db.max, wide.worst_case_db);
  double share = 0.0;
  for (const PartRank& rank : wide.ranking) share += rank.share;
  EXPECT_NEAR(share, 1.0, 1e-9);
}

Sections notch() {
  constexpr double kNotch = 314.16, kHalfWidth = 50.0;
  Sections out;
  out.sections.push_back(
      {1.0, {{0.0, kNotch}, {0.0, -kNotch}}, {{-kHalfWidth, 310.16}, {-kHalfWidth, -310.16}}});
  out.error = Sections::Error{{Hertz{20.0}, Hertz{120.0}}, 0.0, 0.0, 0.0};
  return out;
}

Options options_of(const Design& design, std::uint64_t samples, int points = 60) {
  Options out;
  out.samples = samples;
  out.grid = judging_grid(design.wanted, design.band, points);
  leave_out_nulls({design}, out.grid);
  return out;
}

// Beside a notch a difference in dB has no bound; all parts at their limits are told as the draws are, as shifts.
TEST(Yield, NoDrawOfANotchIsWorseThanAllPartsAtTheirLimits) {
  const Design design =
      design_of_circuit(synthesis::realise(notch()).circuit, notch(), "notch", OpAmps::ideal);
  const Result drawn = run_monte_carlo(design, options_of(design, 2000), Team());
  EXPECT_LE(drawn.worst_db.max, drawn.worst_case_db);
  EXPECT_GT(drawn.worst_db.max, 0.3 * drawn.worst_case_db);
}

// At the peak of a pole-zero pair no part changes anything to the first order; what is next to it moves there.
TEST(Yield, NoDrawOfASharpPairIsWorseThanAllPartsAtTheirLimits) {
  constexpr double kPeak = 6283.0, kHalfWidth = 60.0;
  Sections sharp;
  sharp.sections.push_back({1.0,
                            {{-kHalfWidth / 3, kPeak}, {-kHalfWidth / 3, -kPeak}},
                            {{-kHalfWidth, kPeak}, {-kHalfWidth, -kPeak}}});
  sharp.error = Sections::Error{{Hertz{500.0}, Hertz{2000.0}}, 0.0, 0.0, 0.0};
  const Design design = design_of_circuit(synthesis::realise(sharp).circuit, sharp, "peak", OpAmps::ideal);
  const Result drawn = run_monte_carlo(design, options_of(design, 2000), Team());
  EXPECT_LE(drawn.worst_db.max, drawn.worst_case_db);
  EXPECT_GT(drawn.worst_db.max, 0.5 * drawn.worst_case_db);
}

TEST(Yield, WithoutTolerancesItSaysWhatJudgeResponsesSays) {
  const synthesis::Circuit circuit = synthesis::realise(notch()).circuit;
  const Design design = design_of_circuit(circuit, notch(), "notch", OpAmps::as_built);
  Options options = options_of(design, 1, 1000);  // the other judge goes on between the points
  options.spread.resistor_percent = options.spread.capacitor_percent = 0.0;
  const ResponseDifference judged = judge_responses(
      [&](const std::vector<Hertz>& grid) { return schematic::network_response(circuit, grid); },
      [](const std::vector<Hertz>& grid) {
        std::vector<std::complex<double>> out;
        for (const Hertz f : grid) out.push_back(notch().response(f.rad_s()));
        return out;
      },
      design.band);
  EXPECT_NEAR(run_monte_carlo(design, options, Team()).worst_db.max / judged.max_magnitude_db, 1.0, 0.01);
}

TEST(Yield, SameBytesForAnyNumberOfThreads) {
  Options options = small(30000);
  options.spread.kind = Spread::Kind::gaussian;
  options.spread.temperature_low_c = -20.0;
  options.spread.temperature_high_c = 70.0;
  options.threads = 1;
  const std::string one = text_of(run_monte_carlo(seed_design(), options, Team()), options);
  for (const int threads : {2, 3, 7}) {
    options.threads = threads;
    EXPECT_EQ(text_of(run_monte_carlo(seed_design(), options, Team()), options), one) << threads;
  }
  options.seed = 2;
  EXPECT_NE(text_of(run_monte_carlo(seed_design(), options, Team()), options), one);
}

TEST(Yield, CountsComeBackFromACheckpoint) {
  const Design design = seed_design();
  Options options = small(3000);
  const Result shape = run_monte_carlo(design, options, Team());
  Counts a(shape);
  a.add(3, 0.1, 2.0);
  a.add_worst(0.1, 2.0, 3.7, true);
  Counts b(shape);
  ASSERT_TRUE(b.from_bytes(a.bytes()));
  EXPECT_EQ(a.bytes(), b.bytes());
  EXPECT_EQ(b.samples(), 1u);
  EXPECT_FALSE(b.from_bytes("short"));
  // A damaged one is not believed, and changes nothing.
  Counts c(shape);
  const std::string empty = c.bytes();
  for (const std::size_t at : {std::size_t{0}, a.bytes().size() / 2, a.bytes().size() - 1}) {
    std::string damaged = a.bytes();
    damaged[at] = static_cast<char>(damaged[at] ^ 1);
    EXPECT_FALSE(c.from_bytes(damaged)) << at;
  }
  EXPECT_FALSE(c.from_bytes(a.bytes() + "x"));
  EXPECT_EQ(c.bytes(), empty);
}

// A checkpoint that does not belong to the job, or is broken, is passed over, not believed.
TEST(Yield, AForeignCheckpointIsPassedOver) {
  const TemporaryFolder folder;
  Options options = small(2000);
  const std::string clean = text_of(run_monte_carlo(seed_design(), options, Team()), options);
  options.checkpoint = folder / "yield.checkpoint";
  write_file(options.checkpoint, "bodesmith yield checkpoint 1\nno such job\n\x01\x02");
  EXPECT_EQ(text_of(run_monte_carlo(seed_design(), options, Team()), options), clean);
  EXPECT_FALSE(std::filesystem::exists(options.checkpoint));
}

TEST(Yield, ToleranceToBuyMeetsTheLimit) {
  Options options = small(2000);
  const Design design = seed_design();
  const auto buy = tolerances_to_buy(design, options, 0.5);
  ASSERT_FALSE(buy.empty());
  ASSERT_TRUE(buy[0].meets);
  options.spread.resistor_percent = buy[0].resistor_percent;
  options.spread.capacitor_percent = buy[0].capacitor_percent;
  EXPECT_LT(run_monte_carlo(design, options, Team()).worst_db.quantile(0.95), 0.52);
  options.samples = 50;
  for (const Purchase& one : tolerances_to_buy(design, options, 1e-3)) EXPECT_FALSE(one.meets);
}

const char* const kPlan =
    R"({"schema":"bodesmith.fpaa_plan/1","board":"an231k04-quad4","chips":[{"chip":1,"master_clock_hz":16e6,
"clocks_hz":{},"cams":[{"name":"F1","cam":"FilterBilinear","option":"Pole and Zero","cab":1,"clock_a_hz":2000,"phase":1,
"requested":{},"realised":{},"capacitors":{"Ca":10,"Cb":200,"Cc":12,"Cd":210},
"z_numerator":[-210,200],"z_denominator":[222,-210]}],"resources":{"opamps":1,"capacitors":4,"comparators":0}}],
"signal_path":["chip1.in1","chip1.F1","chip1.out1"],"error":{"band_hz":[1,100],"max_magnitude_db":0,"max_phase_deg":0,"max_complex_percent":0}})";

TEST(Yield, PlanMismatchFollowsTheCapacitorRatio) {
  const Design design = design_of_plan(parse_json(kPlan, "plan.json"), "plan");
  ASSERT_EQ(design.parts.size(), 4u);
  Options options = small(100000);
  options.grid = {Hertz{0.001}};
  options.spread.mismatch.unit_percent = 0.5;
  // At DC the gain is Ca/Cc: relative variance s^2 (1/10 + 1/12).
  const Result result = run_monte_carlo(design, options, Team());
  const double sigma = 0.005 * std::sqrt(1.0 / 10.0 + 1.0 / 12.0);
  EXPECT_NEAR(result.magnitude_db[0].quantile(0.8413447) / (sigma * kDecibelPerNeper), 1.0, 0.02);
  // And against the z-domain itself: holds and pin are those of every board, but for the input that moves while a capacitor is
  // connected to it, in proportion to the frequency.
  constexpr double kHertz = 1.0;
  const std::complex<double> z1 = std::polar(1.0, -2.0 * 3.14159265358979323846 * kHertz / 2000.0);
  const auto by_hand = [&](double a, double b, double c, double d) {
    return -(a + b * (1.0 - z1)) / (c + d * (1.0 - z1));
  };
  const std::complex<double> ratio =
      design.response(Hertz{kHertz}, std::vector{10.5, 199.0, 11.7, 211.0}) / design.nominal(Hertz{kHertz});
  EXPECT_NEAR(std::abs(ratio - by_hand(10.5, 199.0, 11.7, 211.0) / by_hand(10.0, 200.0, 12.0, 210.0)), 0.0,
              1e-5);
}

TEST(Yield, APlanWhoseCapacitorsDoNotMakeItsCoefficientsIsRefused) {
  // At no frequency, and at rest alone.
  for (const std::string wrong : {"[233,-210]", "[232,-220]"}) {
    std::string text = kPlan;
    text.replace(text.find("[222"), wrong.size(), wrong);
    try {
      design_of_plan(parse_json(text, "plan.json"), "plan");
      FAIL() << wrong;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("plan.json:3"), std::string::npos) << error.what();
    }
  }
}

/// A constant path and a low pass of a slower clock, summed: not a product.
const char* const kParallelPlan =
    R"({"schema":"bodesmith.fpaa_plan/1","board":"an231k04-quad4","chips":[{"chip":1,"master_clock_hz":16e6,
"clocks_hz":{},"cams":[{"name":"Path1","cam":"FilterBilinear","option":"Low Pass","cab":1,"clock_a_hz":4000,"phase":1,
"requested":{},"realised":{},"capacitors":{"Cin":3,"Cint":90,"Cout":3},"z_numerator":[-3],"z_denominator":[93,-90]},
{"name":"Sum1","cam":"SumInv","option":"2 inputs","cab":1,"clock_a_hz":64000,"phase":1,"requested":{},"realised":{},
"capacitors":{"Cin1":20,"aCin1":20,"Cin2":16,"aCin2":16,"Cout":40,"aCout":40},"z_numerator":[-40,20],
"z_numerators":[[-40,20],[-32,16]],"z_denominator":[80,-40]}]}],
"wires":[{"from":"chip1.in1","to":"chip1.Path1"},{"from":"chip1.in1","to":"chip1.Sum1","input":1},
{"from":"chip1.Path1","to":"chip1.Sum1","input":2},{"from":"chip1.Sum1","to":"chip1.out1"}],
"signal_path":["chip1.in1","chip1.Sum1","chip1.out1"],"error":{"band_hz":[1,100],"max_magnitude_db":0,"max_phase_deg":0,"max_complex_percent":0}})";

TEST(Yield, ABoardOfSumsAndClocksIsDrawnAsItRuns) {
  const Design design = design_of_plan(parse_json(kParallelPlan, "plan.json"), "plan");
  ASSERT_TRUE(design.board);
  ASSERT_EQ(design.parts.size(), 9u);
  Options options = small(20000);
  options.grid = {Hertz{0.001}};
  // At DC: -Cin1/Cout + Cin2/Cout * Cin/Cout' = -1/2 + 0.4.
  EXPECT_NEAR(design.nominal(Hertz{0.001}).real(), -0.1, 1e-4);
  const Result result = run_monte_carlo(design, options, Team());
  const double k = 0.005;
  const double variance = 0.25 / 20.0 + 0.16 / 16.0 + 0.01 / 40.0 + 0.16 / 3.0 + 0.16 / 3.0;
  const double sigma = k * std::sqrt(variance) / 0.1;
  EXPECT_NEAR(result.magnitude_db[0].quantile(0.8413447) / (sigma * kDecibelPerNeper), 1.0, 0.03);
  EXPECT_NEAR(result.worst_percent.quantile(0.95) / (100.0 * 1.96 * sigma), 1.0, 0.04);
  EXPECT_NEAR(result.ranking[0].share, 0.16 / 3.0 / variance, 0.02);
}

TEST(Yield, DeviationsFromSectionsHaveTheDesignedErrorInThem) {
  Sections wanted;
  wanted.gain = -0.11;
  Options options = small(1000);
  options.grid = {Hertz{0.001}};
  options.spread.mismatch.unit_percent = 0.0;
  const Design design = design_of_plan(parse_json(kParallelPlan, "plan.json"), "plan", wanted);
  EXPECT_EQ(design.reference_name, "sections");
  EXPECT_NEAR(run_monte_carlo(design, options, Team()).worst_percent.max, 100.0 * (1.0 - 0.1 / 0.11), 0.05);
}

TEST(Yield, TheIntervalOfAShareIsWilsons) {
  // Its ends p are where the share is 1.96 standard deviations of p away.
  const Design design = seed_design();
  Options options = small(64);
  options.limit_db = 0.5;
  Result result = run_monte_carlo(design, options, Team());
  for (const std::uint64_t within : {0U, 1U, 20U, 63U, 64U}) {
    result.within = within;
    const Json json = to_json(result, options)["yield"];
    const double share = static_cast<double>(within) / 64.0;
    EXPECT_DOUBLE_EQ(json["percent"].get<double>(), 100.0 * share);
    for (const char* end : {"percent_low", "percent_high"}) {
      const double p = json[end].get<double>() / 100.0;
      EXPECT_GE(p, 0.0);
      EXPECT_LE(p, 1.0);
      EXPECT_NEAR(64.0 * (share - p) * (share - p), 1.959964 * 1.959964 * p * (1.0 - p), 1e-5)
          << within << end;
    }
    EXPECT_LT(json["percent_low"].get<double>(), json["percent_high"].get<double>());
    EXPECT_DOUBLE_EQ(json["limit_db"].get<double>(), 0.5);
    EXPECT_FALSE(json.contains("limit_deg"));
  }
}

TEST(Yield, RefusesNonsense) {
  Options options = small(0);
  EXPECT_THROW(run_monte_carlo(seed_design(), options, Team()), InputError);
  options = small();
  options.spread.resistor_percent = -1.0;
  EXPECT_THROW(run_monte_carlo(seed_design(), options, Team()), InputError);
  options = small();
  options.grid.clear();
  EXPECT_THROW(run_monte_carlo(seed_design(), options, Team()), InputError);
  options = Options{};
  options.samples = 10;
  options.grid.assign(100000, Hertz{1.0});  // 13 GB of counts
  EXPECT_THROW(run_monte_carlo(seed_design(), options, Team()), InputError);
}

}  // namespace
}  // namespace bodesmith::tolerance
