// RecordOptions: how long the record engine tries before it calls a run diverged (max_parts), and what it keeps of a run
// (same_input).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "chain/inverse.hpp"
#include "chain/registry.hpp"
#include "kept_text.hpp"
#include "simulate/record/dense_signal.hpp"
#include "simulate/record/record_simulator.hpp"

namespace bodesmith::simulate {
namespace {

using chain::Block;
using chain::Chain;
using chain::make_block;

/// 200 Hz, hardening so much that a period of the free spring is a small part of one of the linear one.
Chain wild(double cubic) {
  return {{make_block("resonator")
               .set("gain", 1.0)
               .set("natural_frequency_hz", 200.0)
               .set("damping_ratio", 0.02)
               .set("cubic", cubic)}};
}

std::vector<double> sine(std::size_t n) {
  std::vector<double> u(n);
  for (std::size_t i = 0; i < n; ++i) u[i] = std::sin(2.0 * std::numbers::pi * 0.01 * static_cast<double>(i));
  return u;
}

RecordSimulator simulator(const Chain& chain, double max_parts) {
  RecordOptions options;
  options.max_parts = max_parts;
  return RecordSimulator(chain, 1e-3, options);
}

TEST(MostParts, AStiffSpringIsGivenUpOnlyWhenTheLimitIsLow) {
  const auto u = sine(20000);
  auto patient = simulator(wild(3e3), 64.0);
  const auto y = patient.run(u);
  EXPECT_FALSE(patient.diverged());
  double most = 0.0;
  for (const double v : y) most = std::max(most, std::abs(v));
  EXPECT_GT(most, 0.01);
  EXPECT_LT(most, 1.0);
  auto hasty = simulator(wild(3e3), 0.5);
  const auto cut = hasty.run(u);
  EXPECT_TRUE(hasty.diverged());
  for (const double v : cut) ASSERT_TRUE(std::isfinite(v));
}

TEST(MostParts, ALowLimitChangesNothingWhereItIsNotReached) {
  const auto u = sine(5000);
  auto patient = simulator(wild(0.1), 64.0);
  auto hasty = simulator(wild(0.1), 4.0);
  const auto a = patient.run(u);
  const auto b = hasty.run(u);
  EXPECT_FALSE(hasty.diverged());
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(a[i], b[i]) << i;
}

TEST(MostParts, ARunawaySpringEndsAsDivergedAndFinite) {
  auto runaway = simulator(wild(-5.0), 2.0);
  const auto y = runaway.run(sine(5000));
  EXPECT_TRUE(runaway.diverged());
  for (const double v : y) ASSERT_TRUE(std::isfinite(v));
  // The same object works again with sound values.
  runaway.chain().blocks[0].set("cubic", 0.1);
  runaway.run(sine(5000));
  EXPECT_FALSE(runaway.diverged());
}

/// A curve, dynamics that are not linear, memory, a clock and a lag: every kind of stage.
Chain of_all_kinds() {
  return {{make_block("polynomial").set("coefficients", std::vector<double>{0.0, 1.0, 0.1}),
           make_block("resonator")
               .set("gain", 1.5)
               .set("natural_frequency_hz", 40.0)
               .set("damping_ratio", 0.1)
               .set("cubic", 0.3),
           make_block("prandtl_ishlinskii")
               .set("r", std::vector<double>{0.0, 0.1, 0.3})
               .set("w", std::vector<double>{1.0, 0.2, 0.1}),
           make_block("sample_hold").set("clock_hz", 170.0), make_block("lowpass").set("corner_hz", 60.0)}};
}

void expect_same_bits(std::span<const double> got, std::span<const double> expected, int round) {
  ASSERT_EQ(got.size(), expected.size());
  for (std::size_t i = 0; i < got.size(); ++i)
    ASSERT_EQ(got[i], expected[i]) << "round " << round << ", " << i;
}

TEST(SameInput, BringsTheBitsOfARunFromTheBeginning) {
  const auto u = sine(900);
  const auto other = sine(700);
  RecordOptions options;
  options.same_input = true;
  RecordSimulator again(of_all_kinds(), 1e-3, options);
  // Which value of which block changes before each run; the record changes in one of them.
  struct Change {
    std::size_t block;
    std::size_t parameter;
    double factor;
  };
  const Change changes[] = {{4, 0, 1.1}, {4, 0, 1.0 / 1.1}, {3, 0, 1.2}, {2, 4, 1.5}, {1, 1, 1.05},
                            {4, 0, 1.3}, {0, 2, 1.5},       {2, 5, 0.5}, {4, 0, 1.1}, {1, 2, 2.0}};
  int round = 0;
  for (const Change& change : changes) {
    const auto& input = round == 6 ? other : u;
    auto& parameters = again.chain().blocks[change.block].parameters();
    ASSERT_LT(change.parameter, parameters.size());
    parameters[change.parameter].value *= change.factor;
    const auto got = again.run(input);
    RecordSimulator afresh(again.chain(), 1e-3);
    expect_same_bits(got, afresh.run(input), round++);
  }
}

/// A bend that no three samples show: the line ends where it has left the first one's, upwards as downwards.
TEST(DenseSignal, ALineIsGivenUpOnEitherSide) {
  std::size_t lines[2];
  for (const double side : {1.0, -1.0}) {
    TimeRecord record{"r", 0.0, 1e-3, {}, {}};
    for (int i = 0; i < 200; ++i) record.u.push_back(side * (1.0 + 1e-14 * i * i));
    lines[side > 0.0 ? 0 : 1] = DenseSignal::count_lines(record, 1000);
  }
  EXPECT_EQ(lines[0], lines[1]);
  EXPECT_GT(lines[0], 5u);
  EXPECT_LT(lines[0], 60u);
}

/// A block with numbers of which none is like another; where its type refuses these, whole ones, and what may be left out as it is then. Lists fall and alternate, rise, or (the first) rise from 0.
Block sampled_block(const chain::BlockType& type, int variant, bool whole = false) {
  Block out(type);
  bool first = true;
  int i = variant;
  for (const ParameterSpec& spec : type.specs()) {
    const auto within = [&](double value) {
      return std::clamp(value, std::max(spec.min, -1e9), std::min(spec.max, 1e9));
    };
    ++i;
    if (whole && spec.default_value) continue;
    if (spec.shape == ParameterSpec::Shape::list) {
      std::vector<double> values;
      for (int k = 0; k < 3; ++k) {
        const double value = spec.is_frequency() ? 30.0 * (k + 1) : 0.1 + 0.2 * (variant == 0 ? 2 - k : k);
        values.push_back(within(variant == 0 && k == 1  ? -value
                                : variant == 2 && first ? value - 0.1
                                                        : value));
      }
      out.set(spec.name, values);
      first = false;
    } else if (spec.shape == ParameterSpec::Shape::word) {
      out.set_word(spec.name, spec.words[static_cast<std::size_t>(variant) % spec.words.size()]);
    } else if (spec.shape == ParameterSpec::Shape::flag) {
      out.set(spec.name, variant % 2);
    } else {
      out.set(spec.name, within(spec.is_frequency() ? 25.0 * i
                                : spec.unit == "s"  ? 1.3e-3 * i
                                : whole             ? 1.0
                                                    : 0.15 * i));
    }
  }
  return whole || !out.validate() ? out : sampled_block(type, variant, true);
}

/// What every type of block makes of two sines, its response and slowest time, and the input that gives the sines: three sets of
/// numbers each, to four digits.
TEST(Blocks, OfEveryTypeMakeWhatWasKept) {
  std::vector<double> u(120);
  for (std::size_t i = 0; i < u.size(); ++i)
    u[i] = 0.7 * std::sin(0.11 * static_cast<double>(i)) + 0.3 * std::sin(0.29 * static_cast<double>(i));
  std::string all;
  const auto add = [&](std::span<const double> values) {
    for (const std::size_t k : {1U, 20U, 47U, 80U, 119U})
      all += fmt::format(" {:.4g}", std::round(1e9 * values[k]) * 1e-9 + 0.0);
  };
  for (const chain::BlockType* type : chain::block_type_registry().all()) {
    for (const int variant : {0, 1, 2}) {
      const Block block = sampled_block(*type, variant);
      all += fmt::format("{} {}:", type->name(), variant);
      if (const auto wrong = block.validate()) {
        all += " " + wrong->message + "\n";
        continue;
      }
      RecordSimulator simulator(Chain{{block}}, 1e-3);
      add(simulator.run(u));
      all += fmt::format("; {:.4g} s", block.slowest_time_constant_s());
      if (const auto h = block.response(Hertz{70.0}.rad_s()))
        all += fmt::format("; {:.4g} {:.4g}", h->real(), h->imag());
      if (const auto line = block.affine())
        all += fmt::format("; {:.4g} u + {:.4g}", line->factor, line->constant);
      if (const auto found = block.inverse({0.0, 1e-3, u})) {
        all += fmt::format("; {} out of reach, inverse", found->out_of_reach.size());
        add(found->values);
      }
      all += "\n";
    }
  }
  expect_kept("simulate/record/kept_blocks.txt", all);
}

}  // namespace
}  // namespace bodesmith::simulate
