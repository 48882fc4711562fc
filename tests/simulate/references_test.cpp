#include "simulate/references.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "base/error.hpp"

namespace bodesmith::simulate {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

ReferenceSpec spec_of(const std::string& kind, double hz, double step_s, double duration_s) {
  ReferenceSpec out;
  out.kind = kind;
  out.frequency = Hertz{hz};
  out.last = Hertz{hz};
  out.step_s = step_s;
  out.duration_s = duration_s;
  out.amplitude = 2.0;
  out.offset = 0.5;
  return out;
}

TEST(References, TrianglesSinesAndStairsInClosedForm) {
  // 40 samples a period; and a period that is no whole number of them.
  for (const double step_s : {1e-3, 0.7e-3}) {
    for (const char* kind : {"triangle", "sine", "stair"}) {
      ReferenceSpec spec = spec_of(kind, 25.0, step_s, 0.2);
      spec.steps = 4;
      const TimeRecord made = make_reference(spec);
      EXPECT_EQ(made.size(), static_cast<std::size_t>(std::round(0.2 / step_s)) + 1);
      EXPECT_EQ(made.step_s, step_s);
      for (std::size_t i = 0; i < made.size(); ++i) {
        const double turns = 25.0 * step_s * static_cast<double>(i), part = turns - std::floor(turns + 1e-12);
        const double up = part < 0.5 ? 2.0 * part : 2.0 - 2.0 * part;
        const double wanted = spec.kind == "sine" ? 0.5 - 2.0 * std::cos(kTwoPi * turns)
                              : spec.kind == "triangle"
                                  ? 0.5 + 2.0 * (2.0 * up - 1.0)
                                  : 0.5 + 2.0 * (2.0 * std::floor(4.0 * up + 1e-9) / 4.0 - 1.0);
        EXPECT_NEAR(made.u[i], wanted, 1e-9) << kind << i;
      }
    }
  }
  // Every period has the very same values, however late.
  const TimeRecord late = make_reference(spec_of("sine", 3.0, 1.0 / 30.0, 1000.0));
  for (std::size_t i = 10; i < late.size(); ++i) ASSERT_EQ(late.u[i], late.u[i - 10]);
}

TEST(References, SweepsAndManyLines) {
  ReferenceSpec spec = spec_of("chirp", 2.0, 1e-3, 4.0);
  spec.last = Hertz{50.0};
  const TimeRecord chirp = make_reference(spec);
  // Its phase's slope rises geometrically from one frequency to the other.
  for (const std::size_t i : {1000u, 2500u, 3900u}) {
    const double hz = 2.0 * std::pow(25.0, static_cast<double>(i) / 4000.0);
    const double turns = (hz - 2.0) * 4.0 / std::log(25.0);
    EXPECT_NEAR(chirp.u[i], 0.5 - 2.0 * std::cos(kTwoPi * turns), 1e-9);
  }
  spec.last = spec.frequency;
  EXPECT_NEAR(make_reference(spec).u[130], 0.5 - 2.0 * std::cos(kTwoPi * 0.26), 1e-9);

  spec = spec_of("multisine", 5.0, 1e-3, 0.4);
  spec.last = Hertz{35.0};
  const TimeRecord lines = make_reference(spec);
  double peak = 0.0;
  for (const double u : lines.u) peak = std::max(peak, std::abs(u - 0.5));
  EXPECT_NEAR(peak, 2.0, 1e-12);
  // Odd lines of equal size, the last one too.
  std::vector<double> sizes;
  for (int k = 1; k <= 8; ++k) {
    double re = 0.0, im = 0.0;
    for (std::size_t i = 0; i < 400; ++i) {
      re += (lines.u[i] - 0.5) * std::cos(kTwoPi * 5.0 * k * 1e-3 * double(i)) / 200.0;
      im += (lines.u[i] - 0.5) * std::sin(kTwoPi * 5.0 * k * 1e-3 * double(i)) / 200.0;
    }
    sizes.push_back(std::hypot(re, im));
  }
  for (int k = 1; k <= 8; ++k) EXPECT_NEAR(sizes[std::size_t(k - 1)], k % 2 == 1 ? sizes[0] : 0.0, 1e-9) << k;
  EXPECT_GT(sizes[0], 0.3);
  ReferenceSpec other = spec;
  other.seed = spec.seed + 1;
  EXPECT_NE(make_reference(other).u, lines.u);

  const TimeRecord three = make_reference(spec_of("complex", 1.0, 0.01, 1.0));
  EXPECT_NEAR(
      three.u[25],
      0.415 + 0.23 * (1.0 + 0.3 * std::sin(std::numbers::pi / 4.0) + 0.5 * std::sin(std::numbers::pi / 20.0)),
      1e-12);
}

TEST(References, WhatTheyRepeatWithAndWhatIsRefused) {
  std::set<std::string> swept;
  for (const ReferenceKind& kind : reference_kinds()) {
    if (can_be_swept(kind.name)) swept.insert(kind.name);
    const auto f = fundamental_of(spec_of(kind.name, 7.0, 1e-3, 1.0));
    EXPECT_EQ(f.has_value(), kind.name != std::string("chirp"));
    if (f) {
      EXPECT_EQ(f->value, kind.name == std::string("complex") ? 0.1 : 7.0) << kind.name;
    }
  }
  EXPECT_EQ(swept, (std::set<std::string>{"triangle", "sine", "stair"}));
  EXPECT_EQ(fundamental_of(spec_of("steps", 7.0, 1e-3, 1.0))->value, 7.0);
  EXPECT_NO_THROW(make_reference(spec_of("sine", 50.0, 0.01, 1.0)));
  EXPECT_THROW(make_reference(spec_of("sine", 50.01, 0.01, 1.0)), InputError);
  EXPECT_NO_THROW(make_reference(spec_of("complex", 5000.0, 0.01, 1.0)));
  EXPECT_THROW(make_reference(spec_of("sinus", 5.0, 0.01, 1.0)), InputError);
  EXPECT_THROW(make_reference(spec_of("sine", 5.0, 0.0, 1.0)), InputError);
  EXPECT_THROW(make_reference(spec_of("sine", 0.0, 0.01, 1.0)), InputError);
  EXPECT_THROW(make_reference(spec_of("sine", 5.0, 0.01, 0.004)), InputError);
  ReferenceSpec spec = spec_of("multisine", 5.0, 1e-3, 0.4);
  spec.last = Hertz{4.0};
  EXPECT_THROW(make_reference(spec), InputError);
  spec.last = Hertz{600.0};
  EXPECT_THROW(make_reference(spec), InputError);
  spec = spec_of("stair", 5.0, 1e-3, 0.4);
  spec.steps = 0;
  EXPECT_THROW(make_reference(spec), InputError);
}

}  // namespace
}  // namespace bodesmith::simulate
