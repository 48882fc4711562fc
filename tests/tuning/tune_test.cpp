// Controllers for drawn plants with delay, judged by formulas written out here and by stepping the loop in time.
#include "tuning/tune.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/files.hpp"
#include "numeric/random.hpp"
#include "temporary_folder.hpp"

namespace bodesmith::tuning {
namespace {

using Complex = std::complex<double>;

constexpr double kTwoPi = 6.283185307179586;

/// gain e^(-s delay)/((1 + s lag)(1 + s second_lag)).
struct DrawnPlant {
  double gain = 1.0;
  double lag_s = 1.0;
  double second_lag_s = 0.1;
  double delay_s = 0.1;

  Complex response(Complex s) const {
    return gain * std::exp(-s * delay_s) / ((1.0 + s * lag_s) * (1.0 + s * second_lag_s));
  }
  std::string sections(const std::string& more = "") const {
    const auto number = [](double x) { return std::to_string(x); };
    return "{\"schema\": \"bodesmith.sections/1\", \"gain\": " + number(gain) +
           ", \"delay_s\": " + number(delay_s) + more + ", \"sections\": [{\"gain\": " + number(1.0 / lag_s) +
           ", \"zeros_rad_s\": [], \"poles_rad_s\": [[" + number(-1.0 / lag_s) +
           ", 0]]}, {\"gain\": " + number(1.0 / second_lag_s) + ", \"zeros_rad_s\": [], \"poles_rad_s\": [[" +
           number(-1.0 / second_lag_s) + ", 0]]}]}";
  }
};

std::vector<DrawnPlant> drawn_plants() {
  Random random(20);
  std::vector<DrawnPlant> out;
  for (int i = 0; i < 10; ++i) {
    DrawnPlant p;
    p.gain = (i % 3 == 2 ? -1.0 : 1.0) * std::pow(10.0, 2.0 * random.uniform() - 1.0);
    p.lag_s = std::pow(10.0, -1.0 * random.uniform());
    p.second_lag_s = p.lag_s * (0.05 + 0.4 * random.uniform());
    p.delay_s = p.lag_s * (0.02 + 0.2 * random.uniform());
    out.push_back(p);
  }
  return out;
}

Complex pid(const SeriesController& c, Complex s) {
  return c.pid.proportional + c.pid.integral_per_s / s +
         c.pid.derivative_s * s / (1.0 + s / (kTwoPi * c.pid.derivative_corner.value));
}

struct Scanned {
  double phase_margin_deg = 360.0;
  double gain_margin_db = 1e9;
  double crossover_hz = 0.0;
};

/// Every crossing on a grid of 400 000 frequencies, nearest point.
template <class LoopFunction>
Scanned scan(LoopFunction loop) {
  Scanned out;
  Complex before = loop(1e-4);
  for (int i = 1; i <= 400000; ++i) {
    const double f = 1e-4 * std::pow(10.0, 7.0 * i / 400000);
    const Complex now = loop(f);
    if ((std::abs(before) < 1.0) != (std::abs(now) < 1.0)) {
      out.phase_margin_deg = std::min(out.phase_margin_deg, std::abs(std::arg(-now)) * 360.0 / kTwoPi);
      out.crossover_hz = f;
    }
    if (before.imag() * now.imag() < 0.0 && now.real() < 0.0)
      out.gain_margin_db = std::min(out.gain_margin_db, std::abs(20.0 * std::log10(std::abs(now))));
    before = now;
  }
  return out;
}

/// Where a unit step of the reference ends: small steps in time, the delay a row of past drives.
double settled_value(const DrawnPlant& plant, const SeriesController& c) {
  const double h = std::min(plant.delay_s, plant.second_lag_s) / 200.0;
  const double corner = kTwoPi * c.pid.derivative_corner.value;
  const double step = std::min(h, 0.05 / corner);
  std::vector<double> past(static_cast<std::size_t>(plant.delay_s / step), 0.0);
  double integral = 0.0, slow = 0.0, first = 0.0, y = 0.0;
  const auto steps = static_cast<std::size_t>(60.0 * plant.lag_s / step);
  for (std::size_t i = 0; i < steps; ++i) {
    const double e = 1.0 - y;
    integral += step * e;
    slow += step * corner * (e - slow);
    const double u =
        c.pid.proportional * e + c.pid.integral_per_s * integral + c.pid.derivative_s * corner * (e - slow);
    double& place = past[i % past.size()];
    const double late = place;
    place = u;
    first += step * (plant.gain * late - first) / plant.lag_s;
    y += step * (first - y) / plant.second_lag_s;
  }
  return y;
}

struct Tune : ::testing::Test {
  PlantFamily family(const std::string& text, PlantSpread spread = {}) {
    write_file(folder / "plant.json", text);
    Provenance from;
    return read_plants({(folder / "plant.json").string()}, spread, from);
  }
  static const ControllerKind& kind(std::size_t i) { return *controller_kinds()[i]; }
  TemporaryFolder folder;
};

TEST_F(Tune, TenDrawnPlantsWithDelayKeepWhatWasAsked) {
  for (const DrawnPlant& plant : drawn_plants()) {
    TuneOptions options;
    options.limits = {55.0, 8.0, std::nullopt};
    options.bandwidth = Hertz{0.05 / (plant.delay_s + 0.3 * plant.second_lag_s)};
    const TunedLoop made = tune(family(plant.sections()), kind(0), options);
    EXPECT_TRUE(made.met()) << (made.missed.empty() ? "" : made.missed[0]);
    const Scanned seen = scan([&](double f) {
      const Complex s(0.0, kTwoPi * f);
      return pid(made.controller, s) * plant.response(s);
    });
    EXPECT_GT(seen.phase_margin_deg, 54.4);
    EXPECT_GT(seen.gain_margin_db, 7.9);
    EXPECT_NEAR(seen.crossover_hz, options.bandwidth->value, 1e-3 * options.bandwidth->value);
    const LeastMargins told = least_margins(made.members);
    EXPECT_NEAR(std::abs(*told.phase_margin_deg), seen.phase_margin_deg, 0.05);
    EXPECT_NEAR(std::abs(*told.gain_margin_db), seen.gain_margin_db, 0.02);
    EXPECT_NEAR(settled_value(plant, made.controller), 1.0, 0.02);
  }
}

// Its phase comes back from -180 degrees within a step of the search's grid.
TEST_F(Tune, APhaseThatTouchesTheAxisTwiceIsSeen) {
  const std::string plant =
      R"({"schema": "bodesmith.sections/1", "gain": 0.10956, "delay_s": 1.327e-05, "sections": [
    {"gain": 28985.05, "zeros_rad_s": [], "poles_rad_s": [[-40.0645, 165.4687], [-40.0645, -165.4687]]},
    {"gain": 170909.45, "zeros_rad_s": [], "poles_rad_s": [[-25.65466, 412.6152], [-25.65466, -412.6152]]}]})";
  TuneOptions options;
  options.limits = {38.255, 11.705, std::nullopt};
  const TunedLoop made = tune(family(plant), kind(0), options);
  EXPECT_TRUE(made.met());
  const Scanned seen = scan([&](double f) {
    const Complex s(0.0, kTwoPi * f);
    const auto pair = [&](double real, double imag) { return (s + real) * (s + real) + imag * imag; };
    return pid(made.controller, s) * 0.10956 * std::exp(-1.327e-5 * s) * 28985.05 / pair(40.0645, 165.4687) *
           170909.45 / pair(25.65466, 412.6152);
  });
  EXPECT_GT(seen.gain_margin_db, 11.6);
  EXPECT_NEAR(std::abs(*least_margins(made.members).gain_margin_db), seen.gain_margin_db, 0.02);
}

TEST_F(Tune, WhatTheFitDoesNotKnowIsKeptClearOf) {
  const DrawnPlant plant;
  const std::string fit =
      ", \"fit\": {\"gain_deviation_percent\": 6, \"delay_deviation_s\": 0.01, \"poles\": [{\"frequency_hz\": 0.159155, "
      "\"frequency_deviation_hz\": 0.02}, {\"frequency_hz\": 1.59155, \"frequency_deviation_hz\": null}], \"zeros\": []}";
  TuneOptions options;
  options.bandwidth = Hertz{0.4};
  const PlantFamily plants = family(plant.sections(fit));
  EXPECT_EQ(plants.members.size(), 7u);  // nominal, and gain, delay and the known pole either way
  const TunedLoop made = tune(plants, kind(0), options);
  EXPECT_TRUE(made.met());
  // The corner of it all by hand: 12 % more gain, 20 ms more delay, one at a time.
  const auto least = [&](DrawnPlant moved) {
    return scan([&](double f) {
      const Complex s(0.0, kTwoPi * f);
      return pid(made.controller, s) * moved.response(s);
    });
  };
  DrawnPlant late = plant;
  late.delay_s += 0.02;
  DrawnPlant loud = plant;
  loud.gain *= std::exp(0.12);
  for (const DrawnPlant& moved : {plant, late, loud}) {
    EXPECT_GT(least(moved).phase_margin_deg, 59.3);
    EXPECT_GT(least(moved).gain_margin_db, 5.9);
  }
}

TEST_F(Tune, ABandwidthBeyondTheDelayIsToldAndAReachableOneNamed) {
  TuneOptions options;
  options.bandwidth = Hertz{20.0};
  const TunedLoop made = tune(family(DrawnPlant{}.sections()), kind(0), options);
  EXPECT_FALSE(made.met());
  ASSERT_TRUE(made.reachable_bandwidth);
  options.bandwidth = made.reachable_bandwidth;
  EXPECT_TRUE(tune(family(DrawnPlant{}.sections()), kind(0), options).met());
}

/// Eight times as slow: gains go with the unit of time, margins and the bandwidth's place among the corners stay.
TEST_F(Tune, TheUnitOfTimeChangesNothing) {
  const DrawnPlant plant;
  const DrawnPlant slow{plant.gain, 8.0 * plant.lag_s, 8.0 * plant.second_lag_s, 8.0 * plant.delay_s};
  TuneOptions options;
  options.limits.max_sensitivity = 1.9;
  const TunedLoop here = tune(family(plant.sections()), kind(0), options);
  const TunedLoop there = tune(family(slow.sections()), kind(0), options);
  EXPECT_TRUE(here.met());
  EXPECT_NEAR(8.0 * there.bandwidth.value / here.bandwidth.value, 1.0, 0.01);
  const simulate::PidController& a = here.controller.pid;
  const simulate::PidController& b = there.controller.pid;
  EXPECT_NEAR(b.proportional / a.proportional, 1.0, 0.02);
  EXPECT_NEAR(8.0 * b.integral_per_s / a.integral_per_s, 1.0, 0.02);
  EXPECT_NEAR(b.derivative_s / 8.0 / a.derivative_s, 1.0, 0.02);
  EXPECT_NEAR(8.0 * b.derivative_corner.value / a.derivative_corner.value, 1.0, 0.01);
  EXPECT_NEAR(least_margins(there.members).max_sensitivity, least_margins(here.members).max_sensitivity,
              0.02);
}

TEST_F(Tune, APlantThatIntegratesHasTheSignOfItsSlopeAtRest) {
  // -+40/(s (s/200 + 1)): at rest its phase is that of an integrator, not of a sign.
  for (const double gain : {40.0, -40.0}) {
    const std::string text =
        "{\"schema\": \"bodesmith.sections/1\", \"gain\": " + std::to_string(gain) +
        ", \"sections\": [{\"gain\": 1, \"zeros_rad_s\": [], \"poles_rad_s\": [[0, 0]]}, {\"gain\": 200, "
        "\"zeros_rad_s\": [], \"poles_rad_s\": [[-200, 0]]}]}";
    TuneOptions options;
    options.limits = {50.0, 6.0, std::nullopt};
    options.bandwidth = Hertz{10.0};
    const TunedLoop made = tune(family(text), kind(0), options);
    EXPECT_TRUE(made.met()) << (made.missed.empty() ? "" : made.missed[0]);
    EXPECT_GT(made.controller.pid.proportional * gain, 0.0);
    const Scanned seen = scan([&](double f) {
      const Complex s(0.0, kTwoPi * f);
      return pid(made.controller, s) * gain / (s * (1.0 + s / 200.0));
    });
    EXPECT_GT(seen.phase_margin_deg, 49.5);
    EXPECT_NEAR(seen.crossover_hz, 10.0, 0.02);
  }
}

TEST_F(Tune, ALightResonanceIsNotched) {
  // 1/(1 + s/30) and a mode at 40 Hz, damping .005, 20 dB above what a loop of 10 Hz can bear.
  const std::string text =
      "{\"schema\": \"bodesmith.sections/1\", \"gain\": 1, \"sections\": [{\"gain\": 30, \"zeros_rad_s\": [], "
      "\"poles_rad_s\": [[-30, 0]]}, {\"gain\": 63165.468, \"zeros_rad_s\": [], \"poles_rad_s\": [[-1.256637, 251.324], "
      "[-1.256637, -251.324]]}]}";
  TuneOptions options;
  options.limits = {50.0, 6.0, std::nullopt};
  options.bandwidth = Hertz{10.0};
  EXPECT_FALSE(tune(family(text), kind(0), options).met());
  const PlantFamily plants = family(text, {2.0, 10.0, 2.0});
  const TunedLoop made = tune(plants, kind(2), options);
  EXPECT_TRUE(made.met()) << (made.missed.empty() ? "" : made.missed[0]);
  EXPECT_EQ(made.members.size(), 5u);
  // The mode two percent away is below the margin too, and the sections are the controller.
  for (const double shift : {1.0, 1.02, 1.0 / 1.02}) {
    const Sections whole = made.controller.sections();
    const Scanned seen = scan([&](double f) {
      const Complex s(0.0, kTwoPi * f / shift);
      const Complex mode = 63165.468 / (s * s + 2.513274 * s + 63165.468);
      return whole.response(Complex(0.0, kTwoPi * f)) * 30.0 / (s + 30.0) * mode;
    });
    EXPECT_GT(seen.phase_margin_deg, 49.4) << shift;
    EXPECT_GT(seen.gain_margin_db, 5.9) << shift;
  }
}

/// Two decades above the crossover, in a model of blocks as in sections.
TEST_F(Tune, AResonanceFarAboveTheCrossoverIsSeen) {
  const double w = kTwoPi * 1000.0;
  const auto plant = [&](Complex s) { return 1.0 / (1.0 + 0.004 * s / w + s * s / (w * w)); };
  write_file(
      folder / "plant.toml",
      "schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"resonator\"\nnatural_frequency_hz = 1000.0\n"
      "damping_ratio = 0.002\n");
  Provenance from;
  const PlantFamily plants = read_plants({(folder / "plant.toml").string()}, {}, from);
  EXPECT_EQ(from.inputs.size(), 1u);
  TuneOptions options;
  options.limits = {60.0, 6.0, std::nullopt};
  options.bandwidth = Hertz{5.0};
  const TunedLoop made = tune(plants, kind(0), options);
  const LeastMargins told = least_margins(made.members);
  double most = 0.0;
  for (double f = 0.5; f < 1e4; f *= 1.00005) {
    const Complex s(0.0, kTwoPi * f);
    most = std::max(most, 1.0 / std::abs(1.0 + pid(made.controller, s) * plant(s)));
  }
  EXPECT_NEAR(told.max_sensitivity, most, 0.01 * most);
}

TEST_F(Tune, AFractionalControllerKeepsItsMarginsAsMade) {
  const DrawnPlant plant{2.0, 0.5, 0.05, 0.02};
  TuneOptions options;
  options.bandwidth = Hertz{2.0};
  const TunedLoop made = tune(family(plant.sections()), kind(1), options);
  EXPECT_TRUE(made.met()) << (made.missed.empty() ? "" : made.missed[0]);
  EXPECT_FALSE(made.controller.filter.sections.empty());
  const Sections whole = made.controller.sections();
  const Scanned seen = scan([&](double f) {
    const Complex s(0.0, kTwoPi * f);
    return whole.response(s) * plant.response(s);
  });
  EXPECT_GT(seen.phase_margin_deg, 59.3);
  EXPECT_GT(seen.gain_margin_db, 5.9);
}

TEST_F(Tune, AFractionalControllerGoesAsHighAsItsSectionsKeepTheMargins) {
  // Modes of .8 at 430 Hz and .15 at 1150 Hz side by side: 7 poles miss at 118 Hz what the form keeps there.
  const std::string text =
      "{\"schema\": \"bodesmith.sections/1\", \"gain\": 1, \"delay_s\": 1.4e-4, \"sections\": ["
      "{\"gain\": 0.2618488, \"zeros_rad_s\": [[-84.9445, 5145.478], [-84.9445, -5145.478]], \"poles_rad_s\": [[-40.52655, 2701.466], [-40.52655, -2701.466]]}, "
      "{\"gain\": 5.221021e+07, \"zeros_rad_s\": [], \"poles_rad_s\": [[-144.5133, 7224.218], [-144.5133, -7224.218]]}]}";
  TuneOptions options;
  options.limits = {50.0, 6.0, std::nullopt};
  const TunedLoop made = tune(family(text), kind(1), options);
  EXPECT_TRUE(made.met()) << (made.missed.empty() ? "" : made.missed[0]);
  EXPECT_GT(made.bandwidth.value, 50.0);
}

TEST_F(Tune, ANonlinearModelIsRefused) {
  write_file(folder / "bent.toml",
             "schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"saturation\"\nlower = -1.0\nupper = 1.0\n");
  Provenance from;
  EXPECT_THROW(read_plants({(folder / "bent.toml").string()}, {}, from), InputError);
}

TEST_F(Tune, CornersBeyondTheRangeOfDoublesSquaresAreRefused) {
  write_file(folder / "far.json",
             R"({"schema": "bodesmith.sections/1", "sections": [{"gain": 1e-298, "zeros_rad_s": [[-1e300, 0]],
                 "poles_rad_s": [[-10, 0], [-20, 0]]}]})");
  Provenance from;
  EXPECT_THROW(read_plants({(folder / "far.json").string()}, {}, from), InputError);
}

/// L(j w) from far below to far above its corners.
template <class LoopFunction>
bool stable(LoopFunction loop, int integrators) {
  std::vector<Complex> samples;
  for (int i = 0; i <= 4000; ++i)
    samples.push_back(loop(Complex(0.0, std::pow(10.0, -3.0 + 6.0 * i / 4000))));
  return turns_are_stable(samples, integrators);
}

TEST(LoopTurns, KnowTheGainsAtWhichLoopsBeginToRing) {
  // Routh: k/(s + 1)^3 rings at 8, k/(s (s + 1)^2) at 2; k e^(-s T)/s at k T = pi/2; k (s + 1)/s^2 never.
  for (const double side : {0.97, 1.03}) {
    const bool wanted = side < 1.0;
    EXPECT_EQ(stable([&](Complex s) { return 8.0 * side / std::pow(s + 1.0, 3); }, 0), wanted);
    EXPECT_EQ(stable([&](Complex s) { return 2.0 * side / (s * (s + 1.0) * (s + 1.0)); }, 1), wanted);
    EXPECT_EQ(stable([&](Complex s) { return 0.25 * kTwoPi * side * std::exp(-s) / s; }, 1), wanted);
    EXPECT_TRUE(stable([&](Complex s) { return side * (s + 1.0) / (s * s); }, 2));
  }
  // Positive feedback of more than 1 at rest, and a gain that does not fall.
  EXPECT_FALSE(stable([](Complex s) { return -1.2 / (s + 1.0); }, 0));
  EXPECT_FALSE(stable([](Complex) { return Complex(2.0, 0.0); }, 0));
}

TEST(LoopTurns, ShortfallIsZeroExactlyWhereTheMarginsAre) {
  // L = k/s e^(-s): phase margin 90 deg - k rad at w = k, gain margin pi/(2 k).
  const auto samples = [](double k) {
    std::vector<Complex> out;
    for (int i = 0; i <= 8000; ++i) {
      const Complex s(0.0, std::pow(10.0, -3.0 + 6.0 * i / 8000));
      out.push_back(k * std::exp(-s) / s);
    }
    return out;
  };
  const double k = 0.5;  // 61.35 deg, 9.943 dB
  EXPECT_EQ(shortfall(samples(k), 1, {61.3, 9.9, std::nullopt}), 0.0);
  EXPECT_NEAR(shortfall(samples(k), 1, {70.0, 9.9, std::nullopt}), (70.0 - 61.352) / 70.0, 1e-4);
  EXPECT_NEAR(shortfall(samples(k), 1, {61.3, 12.0, std::nullopt}), (12.0 - 9.943) / 12.0, 1e-4);
  EXPECT_GT(shortfall(samples(k), 1, {61.3, 9.9, 1.2}), 0.0);
  EXPECT_GT(shortfall(samples(1.7), 1, {1e-3, 1e-3, std::nullopt}), 2.0 - 1e-3);
}

/// kp + ki/s + kd s/(1 + s/w_d), times the filter, as sections and at once.
TEST(SeriesController, ItsSectionsAreItsResponse) {
  for (const double kd : {0.0, 0.03}) {
    for (const double ki : {0.0, 12.0}) {
      SeriesController c;
      c.pid.proportional = 0.7;
      c.pid.integral_per_s = ki;
      c.pid.derivative_s = kd;
      c.pid.derivative_corner = Hertz{40.0};
      c.filter = Sections{2.0, {Section{50.0, {}, {-50.0}}}, std::nullopt};
      const double corner = 2.0 * M_PI * 40.0;
      for (const double w : {0.5, 30.0, 2000.0}) {
        const Complex s(0.0, w);
        const Complex wanted = (0.7 + ki / s + kd * s / (1.0 + s / corner)) * 2.0 * 50.0 / (s + 50.0);
        EXPECT_LT(std::abs(c.response(s) / wanted - 1.0), 1e-12) << w;
        EXPECT_LT(std::abs(c.sections().response(s) / wanted - 1.0), 1e-12) << w << " " << kd << " " << ki;
      }
    }
  }
}

}  // namespace
}  // namespace bodesmith::tuning
