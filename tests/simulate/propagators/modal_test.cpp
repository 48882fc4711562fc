// Linear dynamics by their modes: against the full matrix in long double, and where modes are no help.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "chain/registry.hpp"
#include "simulate/propagators/modal.hpp"
#include "simulate/record/modal_pairs.hpp"
#include "simulate/record/record_simulator.hpp"
#include "simulate/records.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::simulate {
namespace {

using chain::Block;
using chain::Chain;
using chain::make_block;

TimeRecord noise_record(std::size_t count, double step_s) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  TimeRecord out;
  out.step_s = step_s;
  for (std::size_t i = 0; i < count; ++i) out.u.push_back(value(random));
  return out;
}

/// First-order low-passes one after the other: each section's x' = p (u - x) over a straight piece of its input is no
/// polynomial, so the oracle steps the whole triangular system in long double, an eighth of the interval at a time, by
/// a Taylor series of 40 terms.
std::vector<double> lowpasses_exactly(const std::vector<double>& corners_hz, const TimeRecord& input) {
  const std::size_t n = corners_hz.size();
  std::vector<long double> x(n, 0.0L);
  std::vector<double> y{0.0};
  for (std::size_t i = 0; i + 1 < input.size(); ++i) {
    const int parts = 8;
    for (int part = 0; part < parts; ++part) {
      const long double h = static_cast<long double>(input.step_s) / parts;
      const long double rise = (static_cast<long double>(input.u[i + 1]) - input.u[i]) / parts;
      const long double begin = input.u[i] + rise * part;
      // Taylor coefficients of every state over the part, section by section: x_{k+1} = p h (v_k - x_k)/(k + 1).
      std::vector<long double> v(40, 0.0L);
      v[0] = begin;
      v[1] = rise;
      for (std::size_t s = 0; s < n; ++s) {
        const long double p = 2.0L * std::numbers::pi_v<long double> * corners_hz[s];
        std::vector<long double> c(40, 0.0L);
        c[0] = x[s];
        for (std::size_t k = 0; k + 1 < 40; ++k)
          c[k + 1] = p * h * (v[k] - c[k]) / static_cast<long double>(k + 1);
        x[s] = 0.0L;
        for (std::size_t k = 40; k-- > 0;) x[s] += c[k];
        v = c;
      }
    }
    y.push_back(static_cast<double>(x.back()));
  }
  return y;
}

Chain lowpass_row(const std::vector<double>& corners_hz) {
  Chain out;
  for (const double f : corners_hz) out.blocks.push_back(make_block("lowpass").set("corner_hz", f));
  return out;
}

TEST(ModalPropagator, EightSectionsAreExactWithoutASecondRun) {
  const std::vector<double> corners = {3.0, 11.0, 40.0, 130.0, 5.0, 70.0, 200.0, 20.0};
  const TimeRecord in = noise_record(2000, 1e-3);
  const Result got = simulate(lowpass_row(corners), in, Options());
  EXPECT_EQ(got.stats.engine, Engine::record);
  EXPECT_EQ(got.stats.steps, in.size());
  ASSERT_TRUE(got.error_estimate.has_value());
  const double error = max_difference(got.y, lowpasses_exactly(corners, in));
  EXPECT_LT(error, *got.error_estimate);
  EXPECT_LT(error, 1e-14);
}

TEST(ModalPropagator, HoldsSixPairs) {
  const ModalPropagator::Output end{.s = 1.0, .weights = {0.0, 1.0}};
  const auto is_held = [&](const Chain& chain) {
    chain::LinearKernel all = chain::gain_kernel(1.0);
    for (const Block& block : chain.blocks)
      all = in_series(all, std::get<chain::LinearKernel>(block.kernel()));
    return ModalPropagator().prepare(all, 1e-3, hold_nodes(1), {&end, 1});
  };
  std::vector<double> corners;
  for (int i = 0; i < 12; ++i) corners.push_back(2.0 * std::pow(3.0, i));
  EXPECT_TRUE(is_held(lowpass_row(corners)));
  corners.push_back(1.0);
  EXPECT_FALSE(is_held(lowpass_row(corners)));
  // Of nine real modes one stands alone: with one complex pair more they are six pairs.
  corners.resize(9);
  Chain chain = lowpass_row(corners);
  chain.blocks.push_back(make_block("resonator").set("natural_frequency_hz", 35.0).set("damping_ratio", 0.1));
  EXPECT_TRUE(is_held(chain));
}

TEST(ModalPropagator, EqualSectionsGoByTheFullMatrix) {
  const chain::LinearKernel one = std::get<chain::LinearKernel>(lowpass_row({30.0}).blocks[0].kernel());
  EXPECT_TRUE(modal_pairs(one).has_value());
  EXPECT_FALSE(modal_pairs(in_series(one, one)).has_value());
  const TimeRecord in = noise_record(1500, 1e-3);
  for (const std::size_t count : {8U, 14U}) {  // of a fixed size, and of any
    const std::vector<double> corners(count, 30.0);
    const Result got = simulate(lowpass_row(corners), in, Options());
    const double error = max_difference(got.y, lowpasses_exactly(corners, in));
    EXPECT_LT(error, *got.error_estimate) << count;
    EXPECT_LT(error, 1e-13) << count;
  }
  Chain direct;
  for (int i = 0; i < 14; ++i)
    direct.blocks.push_back(make_block("pole_zero").set("zero_hz", 28.0).set("pole_hz", 30.0));
  const Result alone = simulate(direct, in, by_record(1, Start::zero));
  EXPECT_LT(max_difference(alone.y, simulate(direct, in, by_record(3, Start::zero)).y), 1e-8);
}

/// A chain of every kind of linear block: real and complex modes, an odd number of them, constants.
Chain mixed_linear_chain(double delay_s) {
  Chain out = lowpass_row({7.0, 90.0, 25.0});
  out.blocks.push_back(
      make_block("resonator").set("gain", 1.5).set("natural_frequency_hz", 35.0).set("damping_ratio", 0.1));
  if (delay_s > 0.0) out.blocks.push_back(make_block("delay").set("delay_s", delay_s));
  out.blocks.push_back(make_block("pole_zero").set("gain", 0.8).set("zero_hz", 12.0).set("pole_hz", 60.0));
  out.blocks.push_back(
      make_block("resonator").set("gain", 1.0).set("natural_frequency_hz", 110.0).set("damping_ratio", 0.3));
  return out;
}

TEST(ModalPropagator, PairsAndDelaysAgreeWithCvode) {
  const auto in = record_of(301, 2e-3, two_sines);
  for (const double delay : {0.0, 0.006, 0.0053}) {
    for (const Start start : {Start::zero, Start::equilibrium}) {
      const Result got = simulate(mixed_linear_chain(delay), in, by_record(1, start));
      EXPECT_LT(max_difference(got.y, simulate(mixed_linear_chain(delay), in, cvode(1e-11, start)).y), 2e-9)
          << delay;
    }
  }
}

// Without modes of their own: equal lags by the full matrix, between samples and late.
TEST(ModalPropagator, EqualSectionsAndDelaysAgreeWithCvode) {
  for (const double delay : {0.0, 0.006, 0.0053}) {
    Chain chain = lowpass_row({30.0, 30.0, 30.0});
    if (delay > 0.0) chain.blocks.push_back(make_block("delay").set("delay_s", delay));
    chain.blocks.push_back(make_block("polynomial").set("coefficients", std::vector<double>{0.0, 1.0, 0.2}));
    chain.blocks.push_back(make_block("lowpass").set("corner_hz", 60.0));
    const auto in = record_of(201, 2e-3, two_sines);
    for (const Start start : {Start::zero, Start::equilibrium}) {
      const auto exact = simulate(chain, in, cvode(1e-11, start)).y;
      EXPECT_LT(max_difference(simulate(chain, in, by_record(8, start)).y, exact), 2e-7) << delay;
    }
  }
}

TEST(ModalPropagator, TheSamplesAreThoseOfAnyOtherStep) {
  Chain chain = mixed_linear_chain(0.004);
  chain.blocks.insert(chain.blocks.begin(), make_block("gain").set("gain", 1.1).set("offset", 0.2));
  chain.blocks.push_back(make_block("saturation").set("lower", -0.4).set("upper", 0.6));
  const auto in = record_of(401, 2e-3, two_sines, 0.01);
  for (const Start start : {Start::zero, Start::equilibrium}) {
    const Result alone = simulate(chain, in, by_record(1, start));
    // Three steps a sample interval: no short cut is taken there.
    EXPECT_LT(max_difference(alone.y, simulate(chain, in, by_record(3, start)).y), 1e-13);
  }
}

TEST(ModalPropagator, BehindACurveTheyAgreeWithCvode) {
  Chain chain = lowpass_row({4.0, 9.0, 22.0, 50.0, 120.0, 15.0});
  chain.blocks.insert(chain.blocks.begin(),
                      make_block("polynomial").set("coefficients", std::vector<double>{0.1, 1.0, 0.3, -0.2}));
  const auto in = record_of(251, 2e-3, two_sines);
  const Result got = simulate(chain, in, by_record(8));
  EXPECT_LT(max_difference(got.y, simulate(chain, in, cvode()).y), 2e-9);
}

TEST(ModalPropagator, ARecordThatDiesAwayStaysCheapAndEndsAtZero) {
  TimeRecord in;
  in.step_s = 1e-3;
  in.u.assign(20000, 0.0);
  in.u[1] = 1.0;
  const Result got = simulate(lowpass_row({10.0, 20.0, 40.0, 80.0, 160.0}), in, Options());
  EXPECT_EQ(got.y.back(), 0.0);
}

}  // namespace
}  // namespace bodesmith::simulate
