// simulate() is the judge of every drive here.
#include "invert/compensation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "base/error.hpp"
#include "base/files.hpp"
#include "chain/inverse.hpp"
#include "chain/registry.hpp"
#include "invert/drive_search.hpp"
#include "signal/statistics.hpp"
#include "simulate/simulate.hpp"
#include "temporary_folder.hpp"

namespace bodesmith::invert {
namespace {

using chain::Block;
using chain::Chain;
using chain::make_block;

constexpr double kTau = 2.0 * std::numbers::pi;

/// Smooth, with turns at several heights.
TimeRecord smooth_reference(std::size_t samples = 800, double per_period = 200.0) {
  TimeRecord out;
  out.step_s = 1.0 / per_period;
  for (std::size_t i = 0; i < samples; ++i) {
    const double t = static_cast<double>(i) / per_period;
    out.u.push_back(0.5 - 0.32 * std::cos(kTau * t) - 0.13 * std::cos(kTau * 2.37 * t));
  }
  return out;
}

std::vector<double> judged(const Chain& chain, const TimeRecord& reference, const std::vector<double>& drive,
                           const Options& options = {}) {
  TimeRecord record = as_read_back(reference);
  record.u = drive;
  simulate::Options how;
  how.start = options.start;
  return simulate::simulate(chain, record, how).y;
}

double percent(const Compensation& found, const TimeRecord& reference, std::size_t first = 40) {
  return error_figures(found.predicted, reference.u, first).rms_percent;
}

std::vector<Block> palette() {
  std::vector<Block> out;
  out.push_back(make_block("gain").set("gain", -1.5).set("offset", 0.2));
  out.push_back(make_block("lowpass").set("corner_hz", 20.0));
  out.push_back(make_block("pole_zero").set("gain", 1.2).set("zero_hz", 5.0).set("pole_hz", 12.0));
  out.push_back(make_block("fractional_lead_lag").set("lambda_s", 0.1).set("x", 0.3).set("beta", 0.4));
  out.push_back(make_block("resonator").set("natural_frequency_hz", 30.0).set("damping_ratio", 0.1));
  out.push_back(make_block("resonator")
                    .set("natural_frequency_hz", 30.0)
                    .set("damping_ratio", 0.2)
                    .set("cubic", 0.2)
                    .set("quadratic", 0.1));
  out.push_back(make_block("delay").set("delay_s", 0.013));
  out.push_back(make_block("saturation").set("lower", -9.0).set("upper", 9.0));
  out.push_back(make_block("slew_limit").set("rate_per_s", 300.0));
  out.push_back(make_block("polynomial").set("coefficients", std::vector{0.1, 1.0, 0.05, 0.03}));
  out.push_back(make_block("creep")
                    .set("gains", std::vector{0.1, 0.05})
                    .set("time_constants_s", std::vector{1.0, 0.1}));
  out.push_back(make_block("hum").set("amplitude", 0.05).set("frequency_hz", 7.3).set("phase_deg", 20.0));
  out.push_back(make_block("drift").set("rate_per_s", 0.02));
  out.push_back(make_block("prandtl_ishlinskii")
                    .set("r", std::vector{0.0, 0.1, 0.3})
                    .set("w", std::vector{1.0, 0.2, 0.15}));
  out.push_back(make_block("bouc_wen").set("k", 1.0).set("A", 0.5).set("beta", 1.3).set("gamma", 0.9));
  out.push_back(make_block("preisach")
                    .set("u_min", -6.0)
                    .set("u_max", 6.0)
                    .set("offset", -5.0)
                    .set("w", std::vector{1.2, 0.8, 1.2, 0.5, 0.9, 1.2, 0.3, 0.5, 0.8, 1.1}));
  return out;
}

TEST(Compensation, RandomChainsAreInvertedAndTheErrorIsThatOfSimulate) {
  const std::vector<Block> blocks = palette();
  const TimeRecord reference = smooth_reference();
  for (unsigned seed = 1; seed <= 16; ++seed) {
    std::mt19937 random(seed);
    Chain chain;
    std::string names;
    const std::size_t count = 2 + random() % 4;
    for (std::size_t i = 0; i < count; ++i) {
      chain.blocks.push_back(blocks[random() % blocks.size()]);
      names += " " + chain.blocks.back().type_name();
    }
    const Compensation found = compensate(chain, reference, {});
    EXPECT_EQ(found.predicted, judged(chain, reference, found.drive)) << names;
    EXPECT_LT(percent(found, reference), 0.1) << seed << names;
    EXPECT_TRUE(found.without_inverse.empty()) << names;
  }
}

TEST(Compensation, EveryBlocksOwnInverseIsOne) {
  const TimeRecord reference = smooth_reference();
  std::vector<Block> blocks = palette();
  blocks.push_back(make_block("parallel_modes")
                       .set("gains", std::vector{0.2, -0.1})
                       .set("natural_frequencies_hz", std::vector{25.0, 40.0})
                       .set("damping_ratios", std::vector{0.1, 0.1}));
  blocks.push_back(make_block("right_half_plane_zero").set("right_zero_hz", 20.0).set("pole_hz", 30.0));
  blocks.push_back(make_block("dead_zone").set("width", 0.1));
  blocks.push_back(make_block("backlash").set("width", 0.1));
  blocks.push_back(make_block("sample_hold").set("clock_hz", 400.0));
  blocks.push_back(make_block("multiplier").set("scale_v", 1.0).set("x_offset_v", 0.1));
  blocks.push_back(make_block("voltage_controlled_gain").set("gain", 2.0).set("control_v", 0.5));
  blocks.push_back(
      make_block("opamp").set("gain", 2.0).set("gain_bandwidth_hz", 200.0).set("slew_rate_v_per_s", 1e3));
  blocks.push_back(make_block("polynomial_hysteresis")
                       .set("ascending", std::vector{0.1, -0.1, 0.0})
                       .set("descending", std::vector{-0.1, 0.1, 0.0}));
  for (const Block& block : blocks) {
    const auto found = block.inverse({0.0, reference.step_s, reference.u});
    ASSERT_TRUE(found.has_value()) << block.type_name();
    const std::vector<double> y = judged(Chain{{block}}, reference, found->values);
    const double tolerance = block.type_name() == "polynomial_hysteresis" ? 3.0 : 0.8;
    EXPECT_LT(error_figures(y, reference.u, 10).rms_percent, tolerance) << block.type_name();
  }
  EXPECT_FALSE(make_block("comparator").inverse({0.0, 1.0, {0.0, 1.0}}).has_value());
}

/// Behind the chain's delay and, from zero, behind seven of its slowest time constants: half the record at most.
TEST(SteadyState, BeginsWhereTheStartIsForgotten) {
  Chain chain;
  chain.blocks = {make_block("lowpass").set("corner_hz", 8.0), make_block("delay").set("delay_s", 0.0523),
                  make_block("lowpass").set("corner_hz", 20.0)};
  TimeRecord reference = smooth_reference();  // steps of 5 ms
  Options options;
  options.start = simulate::Start::equilibrium;
  EXPECT_EQ(steady_state_of(chain, reference, options, std::nullopt).first, 11u);
  options.start = simulate::Start::zero;
  double wait_s = 0.0523;
  for (const Block& block : chain.blocks) wait_s += 7.0 * block.slowest_time_constant_s();
  EXPECT_EQ(steady_state_of(chain, reference, options, std::nullopt).first,
            static_cast<std::size_t>(std::ceil(wait_s / 0.005)));
  EXPECT_EQ(steady_state_of(chain, reference, options, 0.1).first, 20u);
  EXPECT_EQ(steady_state_of(chain, reference, options, 0.1001).first, 21u);
  EXPECT_THROW(steady_state_of(chain, reference, options, reference.duration_s()), InputError);
  reference.u.resize(60);
  EXPECT_EQ(steady_state_of(chain, reference, options, std::nullopt).first, 30u);
  // Of what repeats the last period.
  for (std::size_t i = 0; i < 60; ++i) reference.u[i] = std::sin(kTau * static_cast<double>(i) / 20.0);
  for (std::size_t i = 20; i < 60; ++i) reference.u[i] = reference.u[i - 20];
  EXPECT_EQ(steady_state_of(chain, reference, options, std::nullopt).first, 40u);
  EXPECT_EQ(steady_state_of(Chain{}, smooth_reference(), options, std::nullopt).first, 1u);
}

TEST(Compensation, LooksAheadByTheDelayOrLagsByIt) {
  Chain chain;
  chain.blocks = {make_block("gain").set("gain", 2.0).set("offset", 1.0),
                  make_block("delay").set("delay_s", 0.003)};
  TimeRecord reference;
  reference.step_s = 1e-3;
  for (int i = 0; i < 100; ++i) reference.u.push_back(0.1 * i);
  const Compensation ahead = compensate(chain, reference, {});
  for (std::size_t i = 3; i < 97; ++i) EXPECT_NEAR(ahead.predicted[i], reference.u[i], 1e-9) << i;
  Options causal;
  causal.preview = false;
  const Compensation late = compensate(chain, reference, causal);
  for (std::size_t i = 3; i < 97; ++i) EXPECT_NEAR(late.predicted[i], reference.u[i - 3], 1e-9) << i;
  EXPECT_NEAR(late.delay_s, 0.003, 1e-15);
}

// A hold counts as half its period to the search, and is looked ahead of.
TEST(Compensation, AClockedBlockIsADelayToTheSearch) {
  Chain chain;
  chain.blocks = {make_block("sample_hold").set("clock_hz", 500.0), palette()[5]};
  const TimeRecord reference = smooth_reference();
  const Compensation found = compensate(chain, reference, {});
  EXPECT_NEAR(found.delay_s, 0.001, 1e-12);
  EXPECT_LT(percent(found, reference), 0.5);
  EXPECT_EQ(found.predicted, judged(chain, reference, found.drive));
}

TEST(Compensation, ARightHalfPlaneZeroGetsABoundedDrive) {
  // 1 - 2.6/(1 + s/w): a zero in the right half plane.
  Chain chain;
  chain.blocks = {
      make_block("creep").set("gains", std::vector{-2.6}).set("time_constants_s", std::vector{0.02})};
  const TimeRecord reference = smooth_reference();
  const Compensation found = compensate(chain, reference, {});
  EXPECT_LT(percent(found, reference), 0.01);
  for (const double u : found.drive) EXPECT_LT(std::abs(u), 10.0);
}

TEST(Compensation, AHighPassGetsTheIntegralsOfWhatIsWanted) {
  // r = u'' / (u'' + 2 zeta w u' + w^2 u) from rest: u = r + 2 zeta w int r + w^2 int int r, in closed form for r = 1 - cos(vt).
  const double zeta = 0.7, w = kTau * 0.4, v = kTau;
  const Chain chain{{make_block("biquad")
                         .set("lowpass_gain", 0.0)
                         .set("highpass_gain", 1.0)
                         .set("natural_frequency_hz", w / kTau)
                         .set("damping_ratio", zeta)}};
  TimeRecord reference;
  reference.step_s = 0.005;
  std::vector<double> closed_form;
  for (std::size_t i = 0; i < 600; ++i) {
    const double t = static_cast<double>(i) * reference.step_s;
    reference.u.push_back(1.0 - std::cos(v * t));
    closed_form.push_back(reference.u.back() + 2.0 * zeta * w * (t - std::sin(v * t) / v) +
                          w * w * (0.5 * t * t + (std::cos(v * t) - 1.0) / (v * v)));
  }
  const auto found = compensate(chain, reference, {});
  for (std::size_t i = 0; i < closed_form.size(); ++i) EXPECT_NEAR(found.drive[i], closed_form[i], 2e-3) << i;
}

TEST(Compensation, LimitsHoldAndWhatTheyTakeAwayIsSaid) {
  Chain chain;
  chain.blocks = {make_block("lowpass").set("corner_hz", 8.0), palette()[13],
                  make_block("resonator").set("natural_frequency_hz", 40.0).set("damping_ratio", 0.1)};
  const TimeRecord reference = smooth_reference();
  Options options;
  options.limits.upper = 0.6;
  options.limits.max_rate_per_s = 2.0;
  const Compensation found = compensate(chain, reference, options);
  for (std::size_t i = 1; i < found.drive.size(); ++i) {
    EXPECT_LE(found.drive[i], 0.6);
    EXPECT_LE(std::abs(found.drive[i] - found.drive[i - 1]), 2.0 * reference.step_s * (1.0 + 1e-9));
  }
  ASSERT_EQ(found.out_of_reach.size(), 2u);
  EXPECT_GT(found.samples_out_of_reach, 10u);
  EXPECT_EQ(found.predicted, judged(chain, reference, found.drive));
  // Far better than cutting the free drive off.
  std::vector<double> cut = compensate(chain, reference, {}).drive;
  options.limits.hold(cut, reference.step_s);
  const double cut_off = error_figures(judged(chain, reference, cut), reference.u, 40).rms;
  EXPECT_LE(error_figures(found.predicted, reference.u, 40).rms, cut_off);
}

TEST(Compensation, TheBandwidthHolds) {
  Chain chain;
  chain.blocks = {make_block("backlash").set("width", 0.1), make_block("lowpass").set("corner_hz", 8.0)};
  const TimeRecord reference = smooth_reference();
  Options options;
  options.bandwidth = Hertz{15.0};
  const Compensation found = compensate(chain, reference, options);
  const std::vector<double> again = band_limited(found.drive, reference.step_s, Hertz{15.0 / 0.8});
  EXPECT_LT(error_figures(again, found.drive).max, 1e-9);
  EXPECT_LT(percent(found, reference), 2.0);
}

TEST(Compensation, ABlockWithoutInverseIsFoundNumerically) {
  Chain chain;
  Block comparator = make_block("comparator").set("threshold_v", 0.4);
  chain.blocks = {comparator, make_block("lowpass").set("corner_hz", 2.0)};
  const TimeRecord reference = smooth_reference();
  const Compensation found = compensate(chain, reference, {});
  ASSERT_EQ(found.without_inverse.size(), 1u);
  EXPECT_NE(found.without_inverse[0].find("comparator"), std::string::npos);
  EXPECT_EQ(found.predicted, judged(chain, reference, found.drive));
}

TEST(Compensation, LongRecordsGoInWindows) {
  Chain chain;
  chain.blocks = {make_block("lowpass").set("corner_hz", 8.0), palette()[5],
                  make_block("delay").set("delay_s", 0.02)};
  const TimeRecord reference = smooth_reference(21000);
  const Compensation found = compensate(chain, reference, {});
  EXPECT_LT(percent(found, reference), 0.01);
}

TEST(Compensation, WhatABlockCannotGiveIsSaidAndTheLowerLimitIsNamed) {
  Chain chain;
  chain.blocks = {make_block("saturation").set("lower", -0.5).set("upper", 0.5)};
  TimeRecord reference;
  reference.step_s = 1e-3;
  for (int i = 0; i < 100; ++i) reference.u.push_back(-1.0 + 0.01 * i);
  const Compensation found = compensate(chain, reference, {});
  ASSERT_FALSE(found.out_of_reach.empty());
  EXPECT_NE(found.out_of_reach[0].why.find("block 1 (saturation) gives no such output"), std::string::npos);
  EXPECT_EQ(found.out_of_reach[0].samples, 50u);
  EXPECT_DOUBLE_EQ(found.out_of_reach[0].to_s, 0.049);
  Options options;
  options.limits.lower = -0.2;
  const Compensation limited = compensate({{make_block("gain")}}, reference, options);
  ASSERT_EQ(limited.out_of_reach.size(), 1u);
  EXPECT_NE(limited.out_of_reach[0].why.find("lower limit"), std::string::npos);
  EXPECT_EQ(limited.samples_out_of_reach, 80u);
  EXPECT_DOUBLE_EQ(limited.out_of_reach[0].from_s, 0.0);
  options.limits = {};
  options.limits.upper = -0.5;
  const Compensation from_half = compensate({{make_block("gain")}}, reference, options);
  ASSERT_EQ(from_half.out_of_reach.size(), 1u);
  EXPECT_DOUBLE_EQ(from_half.out_of_reach[0].from_s, 0.051);
  EXPECT_DOUBLE_EQ(from_half.out_of_reach[0].to_s, 0.099);
}

TEST(InverseFile, ReadsBackWhatItWroteAndSaysWhatIsWrong) {
  const TemporaryFolder folder;
  write_file(folder / "model.toml", "schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"gain\"\n");
  const auto read = [&](const std::string& text) {
    write_file(folder / "inverse.toml", text);
    Provenance from;
    return InverseFile::read(folder / "inverse.toml", from);
  };
  Options options;
  options.start = simulate::Start::zero;
  options.preview = false;
  options.limits = {-1.5, 2.5, 300.0};
  options.bandwidth = Hertz{70.0};
  const InverseFile got = read(InverseFile::text("model.toml", options));
  EXPECT_EQ(got.options.start, simulate::Start::zero);
  EXPECT_FALSE(got.options.preview);
  EXPECT_EQ(got.options.limits.lower, -1.5);
  EXPECT_EQ(got.options.limits.upper, 2.5);
  EXPECT_EQ(got.options.limits.max_rate_per_s, 300.0);
  EXPECT_EQ(got.options.bandwidth->value, 70.0);
  EXPECT_EQ(got.model.blocks.size(), 1u);
  EXPECT_TRUE(read(InverseFile::text("model.toml", {})).options.preview);
  EXPECT_FALSE(read(InverseFile::text("model.toml", {})).options.limits.lower.has_value());
  EXPECT_THROW(read(InverseFile::text("none.toml", {})), InputError);
  EXPECT_THROW(read(InverseFile::text("model.toml", {}) + "lower = 1.0\nupper = 1.0\n"), InputError);
  EXPECT_THROW(read(InverseFile::text("model.toml", {}) + "max_rate_per_s = 0.0\n"), InputError);
}

TEST(Compensation, RefusesWhatCannotBe) {
  const Chain chain{{make_block("gain")}};
  Options options;
  options.bandwidth = Hertz{1e6};
  EXPECT_THROW(compensate(chain, smooth_reference(), options), InputError);
  options.bandwidth.reset();
  options.limits.lower = 1.0;
  options.limits.upper = 0.0;
  EXPECT_THROW(compensate(chain, smooth_reference(), options), InputError);
}

}  // namespace
}  // namespace bodesmith::invert
