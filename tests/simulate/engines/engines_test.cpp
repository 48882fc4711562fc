// Two engines that share no code on drawn chains: memory, curves, clocks, sources and dynamics in any order.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "base/error.hpp"
#include "chain/registry.hpp"
#include "numeric/random.hpp"
#include "simulate/records.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::simulate {
namespace {

using chain::Block;
using chain::Chain;
using chain::make_block;
using List = std::vector<double>;

struct Draw : Random {
  using Random::Random;
  double between(double low, double high) { return low + (high - low) * uniform(); }
  double ratio(double low, double high) { return low * std::pow(high / low, uniform()); }
};

using Maker = std::function<Block(Draw&)>;

/// A signal that rests may move either way by rounding: what shows that as a jump is not drawn together with what makes rests.
std::vector<Maker> makers(bool with_jumps) {
  std::vector<Maker> all = {
      [](Draw& d) { return make_block("lowpass").set("corner_hz", d.ratio(2.0, 200.0)); },
      [](Draw& d) {
        return make_block("pole_zero")
            .set("zero_hz", d.ratio(3.0, 100.0))
            .set("pole_hz", d.ratio(3.0, 100.0));
      },
      [](Draw& d) {
        return make_block("resonator")
            .set("natural_frequency_hz", d.ratio(10.0, 100.0))
            .set("damping_ratio", d.ratio(0.05, 0.5));
      },
      [](Draw& d) { return make_block("slew_limit").set("rate_per_s", d.ratio(2.0, 30.0)); },
      [](Draw& d) { return make_block("drift").set("rate_per_s", d.between(-0.2, 0.2)); },
      [](Draw& d) {
        return make_block("sample_hold").set("clock_hz", d.ratio(30.0, 800.0)).set("half_cycle", 1.0);
      },
      [](Draw& d) {
        return make_block("switched_capacitor")
            .set("clock_hz", d.ratio(100.0, 900.0))
            .set("z_numerator", List{0.3, 0.1})
            .set("z_denominator", List{1.0, -0.6});
      },
      [](Draw&) {
        return make_block("prandtl_ishlinskii").set("r", List{0.0, 0.1, 0.25}).set("w", List{0.6, 0.3, 0.2});
      },
      [](Draw&) {
        return make_block("preisach")
            .set("u_min", -1.0)
            .set("u_max", 1.5)
            .set("w", List{0.2, 0.1, 0.3, 0.15, 0.05, 0.2});
      },
      [](Draw&) {
        return make_block("exponential_operator").set("k", List{0.5, 0.3}).set("tau", List{3.0, 1.0});
      },
  };
  const std::vector<Maker> rests = {
      [](Draw& d) { return make_block("saturation").set("lower", -0.5).set("upper", d.between(0.3, 0.9)); },
      [](Draw& d) { return make_block("dead_zone").set("width", d.between(0.05, 0.3)); },
      [](Draw& d) { return make_block("backlash").set("width", d.between(0.05, 0.3)); },
  };
  const std::vector<Maker> jumps = {
      [](Draw& d) {
        return make_block("polynomial_hysteresis")
            .set("ascending", List{0.3, -0.5, 0.2})
            .set("descending", List{-0.2, 0.1, 0.1})
            .set("switch_delay_s", d.below(2) == 0 ? 0.0 : d.ratio(0.0003, 0.01));
      },
      [](Draw&) { return make_block("sine_hysteresis").set("A_ascending", 0.1).set("A_descending", -0.08); },
  };
  const std::vector<Maker>& more = with_jumps ? jumps : rests;
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

double wave(std::size_t kind, double f, double t) {
  const double turn = 2.0 * kPi * f * t;
  switch (kind) {
    case 0:
      return 0.5 - 0.5 * std::cos(turn);
    case 1:
      return std::abs(std::remainder(f * t, 1.0)) * 2.0;
    default:
      return 0.4 + 0.25 * std::sin(turn) + 0.15 * std::sin(3.7 * turn + 1.0);
  }
}

class DrawnChains : public ::testing::TestWithParam<unsigned> {};

TEST_P(DrawnChains, AreTheSameInBothEngines) {
  Draw draw(GetParam());
  const std::vector<Maker> made = makers(GetParam() % 2 == 0);
  std::size_t unsolved = 0;
  for (int i = 0; i < 12; ++i) {
    Chain chain;
    std::string names;
    for (std::size_t left = 1 + draw.below(4); left > 0; --left) {
      chain.blocks.push_back(made[draw.below(made.size())](draw));
      names += chain.blocks.back().type_name() + " ";
    }
    const double f = draw.ratio(0.7, 6.0);
    const std::size_t kind = draw.below(3);
    SCOPED_TRACE(names + "wave " + std::to_string(kind) + " at " + std::to_string(f) + " Hz");
    TimeRecord in;
    in.step_s = 0.001;
    for (std::size_t k = 0; k <= 400; ++k) in.u.push_back(wave(kind, f, in.time_s(k)));
    const Start start = draw.below(2) == 0 ? Start::zero : Start::equilibrium;
    Options automatic;
    automatic.start = start;
    const auto y = simulate(chain, in, automatic).y;
    std::vector<double> other;
    try {
      other = simulate(chain, in, cvode(1e-9, start)).y;
    } catch (const InputError&) {  // blocks that switch to and fro without end
      EXPECT_EQ(++unsolved, 1u);
      continue;
    }
    const auto [low, high] = std::minmax_element(other.begin(), other.end());
    const double range = std::max(*high - *low, 0.01);
    // A jump at a sample shows either side of it.
    std::size_t apart = 0;
    for (std::size_t k = 0; k < y.size(); ++k)
      if (std::abs(y[k] - other[k]) > 1e-4 * range) ++apart;
    EXPECT_LE(apart, 4u);
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, DrawnChains, ::testing::Range(1U, 13U));

}  // namespace
}  // namespace bodesmith::simulate
