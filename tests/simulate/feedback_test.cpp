#include "simulate/feedback.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "base/files.hpp"
#include "chain/registry.hpp"
#include "signal/statistics.hpp"
#include "simulate/controller_file.hpp"
#include "simulate/references.hpp"
#include "simulate/simulate.hpp"
#include "temporary_folder.hpp"

namespace bodesmith::simulate {
namespace {

using chain::Chain;
using chain::make_block;

TimeRecord constant(double value, double step_s, std::size_t n) {
  TimeRecord r;
  r.step_s = step_s;
  r.u.assign(n, value);
  return r;
}

TEST(Feedback, ADriveIsAddedWhereItHasTheReferencesTimes) {
  const Chain plant{{make_block("lowpass").set("corner_hz", 8.0)}};
  TimeRecord reference = constant(1.0, 1e-3, 200);
  LoopSetup setup;
  setup.controller.integral_per_s = 20.0;
  setup.drive = constant(0.4, 1e-3, 200);
  const auto got = simulate_loop(plant, setup, reference);
  EXPECT_EQ(got.y, simulate_loop(plant, setup.drive->u, setup.controller, reference).y);
  const auto refused = [&](auto change) {
    LoopSetup other = setup;
    change(*other.drive);
    EXPECT_THROW(simulate_loop(plant, other, reference), InputError);
  };
  refused([](TimeRecord& drive) { drive.u.pop_back(); });
  refused([](TimeRecord& drive) { drive.step_s *= 1.00001; });
  refused([](TimeRecord& drive) { drive.start_s = 0.5e-3; });
}

// What stands behind the controller is the plant's first block to the loop, and the drive is behind it.
TEST(Feedback, AFilterStandsBetweenControllerAndPlant) {
  const Chain plant{{make_block("lowpass").set("corner_hz", 8.0)}};
  const TimeRecord reference = constant(1.0, 1e-3, 200);
  LoopSetup setup;
  setup.controller.integral_per_s = 20.0;
  setup.filter.emplace().sections.push_back(
      Section::pole_zero(1.0, RadPerSecond{200.0}, RadPerSecond{900.0}));
  const LoopResult got = simulate_loop(plant, setup, reference);
  const Chain whole{{make_block("pole_zero")
                         .set("zero_hz", 200.0 / (2.0 * std::numbers::pi))
                         .set("pole_hz", 900.0 / (2.0 * std::numbers::pi)),
                     plant.blocks[0]}};
  const LoopResult same = simulate_loop(whole, std::nullopt, setup.controller, reference);
  ASSERT_EQ(got.y.size(), same.y.size());
  TimeRecord control = reference;
  control.u = same.drive;
  const std::vector<double> drive = simulate({{whole.blocks[0]}}, control, {}).y;
  for (std::size_t i = 0; i < got.y.size(); ++i) {
    EXPECT_NEAR(got.y[i], same.y[i], 1e-9);
    EXPECT_NEAR(got.drive[i], drive[i], 1e-6);
  }
}

TEST(ControllerFile, IsReadWholeAndSaysWhatIsWrong) {
  const TemporaryFolder folder;
  write_file(folder / "drive.csv", "time_s,u\n0,1\n0.001,2\n0.002,3\n");
  write_file(folder / "model.toml", "schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"gain\"\n");
  write_file(folder / "inverse.toml", "schema = \"bodesmith.inverse/1\"\nmodel = \"model.toml\"\n");
  const auto read = [&](const std::string& text) {
    write_file(folder / "controller.toml", "schema = \"bodesmith.controller/1\"\n" + text);
    Provenance from;
    return read_controller(folder / "controller.toml", from);
  };
  const LoopSetup all = read(
      "type = \"pid\"\nkp = 0.5\nki_per_s = 150.0\nkd_s = 1e-4\nderivative_corner_hz = 1e3\nsample_s = 1e-4\nlower = -0.1\n"
      "upper = 1.1\n[filter]\nschema = \"bodesmith.sections/1\"\ngain = 2.0\nsections = []\n");
  EXPECT_EQ(all.controller.proportional, 0.5);
  EXPECT_EQ(all.controller.integral_per_s, 150.0);
  EXPECT_EQ(all.controller.derivative_s, 1e-4);
  EXPECT_EQ(all.controller.derivative_corner.value, 1e3);
  EXPECT_EQ(all.controller.period_s, 1e-4);
  EXPECT_EQ(all.controller.lower, -0.1);
  EXPECT_EQ(all.controller.upper, 1.1);
  EXPECT_EQ(all.filter->gain, 2.0);
  const std::string pi = "type = \"pi\"\nki_per_s = 2.0\n";
  EXPECT_EQ(read(pi).controller.proportional, 0.0);
  EXPECT_FALSE(read(pi).controller.limited());
  EXPECT_EQ(read(pi + "feedforward = \"drive.csv\"\n").drive->u[2], 3.0);
  EXPECT_EQ(read(pi + "feedforward = \"model.toml\"\n").feedforward->blocks.size(), 1u);
  EXPECT_EQ(read(pi + "feedforward = \"inverse.toml\"\n").inverse, folder / "inverse.toml");
  EXPECT_THROW(read("type = \"pi\"\n"), InputError);
  EXPECT_THROW(read("type = \"pid\"\nki_per_s = 2.0\n"), InputError);
  EXPECT_THROW(read(pi + "kd_s = 1.0\n"), InputError);
  EXPECT_THROW(read(pi + "lower = 1.0\nupper = 1.0\n"), InputError);
  EXPECT_THROW(read(pi + "sample_s = 0.0\n"), InputError);
  EXPECT_THROW(read(pi + "feedforward = \"none.toml\"\n"), InputError);
  EXPECT_THROW(read(pi + "feedforward = \"model.toml\"\nfilter = \"notch.json\"\n"), InputError);
}

TEST(Feedback, PiRoundALagIsItsClosedForm) {
  // Plant 1/(1 + s tau), controller ki/s: y'' tau + y' + ki y = ki r.
  const double tau = 0.02;
  const double ki = 30.0;
  const Chain plant{{make_block("lowpass").set("corner_hz", 1.0 / (2.0 * std::numbers::pi * tau))}};
  PidController c;
  c.integral_per_s = ki;
  Options options;
  options.relative_tolerance = 1e-10;
  options.absolute_tolerance = 1e-12;
  const double w = std::sqrt(ki / tau);
  const double zeta = 0.5 / std::sqrt(ki * tau);
  const double wd = w * std::sqrt(1.0 - zeta * zeta);
  for (const Engine engine : {Engine::cvode, Engine::exact}) {
    options.engine = engine;
    const auto got = simulate_loop(plant, std::nullopt, c, constant(1.0, 1e-3, 301), options);
    for (std::size_t i = 0; i < got.y.size(); ++i) {
      const double t = 1e-3 * static_cast<double>(i);
      EXPECT_NEAR(got.y[i],
                  1.0 - std::exp(-zeta * w * t) * (std::cos(wd * t) + zeta * w / wd * std::sin(wd * t)),
                  engine == Engine::exact ? 1e-13 : 1e-8);
    }
    EXPECT_LT(*got.error_estimate, engine == Engine::exact ? 1e-12 : 1e-7);
    EXPECT_EQ(got.stats.engine, engine);
  }
}

TEST(Feedback, SampledPiIsItsDifferenceEquation) {
  const double tau = 0.02;
  const double period = 0.005;
  const Chain plant{{make_block("lowpass").set("corner_hz", 1.0 / (2.0 * std::numbers::pi * tau))}};
  PidController c;
  c.proportional = 0.8;
  c.integral_per_s = 25.0;
  c.derivative_s = 0.002;
  c.derivative_corner = Hertz{40.0};
  c.period_s = period;
  Options options;
  options.relative_tolerance = 1e-11;
  options.absolute_tolerance = 1e-13;
  for (const Engine engine : {Engine::cvode, Engine::exact}) {
    options.engine = engine;
    const auto got = simulate_loop(plant, std::nullopt, c, constant(1.0, period, 60), options);
    double y = 0.0, integral = 0.0, derivative = 0.0, last = 1.0;
    const double a = std::exp(-period / tau);
    const double wd = 2.0 * std::numbers::pi * 40.0 * period;
    const double close = engine == Engine::exact ? 1e-13 : 1e-9;
    for (std::size_t k = 0; k < got.y.size(); ++k) {
      EXPECT_NEAR(got.y[k], y, close) << k;
      const double e = 1.0 - y;
      if (k > 0) integral += 25.0 * period * 0.5 * (e + last);
      derivative = (derivative + 0.002 * wd / period * (e - last)) / (1.0 + wd);
      const double u = 0.8 * e + integral + derivative;
      if (k + 1 < got.y.size()) {
        EXPECT_NEAR(got.drive[k], u, 10.0 * close) << k;
      }
      y = a * y + (1.0 - a) * u;
      last = e;
    }
  }
}

/// A stage as the seeds': amplifier, resonance, offset; a triangle to follow; feed-forward of its gain.
TEST(Feedback, ClosedFormAndCvodeAgree) {
  const Chain plant{{make_block("gain").set("gain", 1.2).set("offset", 0.03),
                     make_block("lowpass").set("corner_hz", 800.0),
                     make_block("pole_zero").set("zero_hz", 40.0).set("pole_hz", 35.0),
                     make_block("resonator").set("natural_frequency_hz", 300.0).set("damping_ratio", 0.2)}};
  ReferenceSpec spec;
  spec.frequency = Hertz{5.0};
  spec.duration_s = 0.4;
  spec.step_s = 1e-3;
  const auto r = make_reference(spec);
  const Chain forward{{make_block("gain").set("gain", 1.0 / 1.2)}};
  Options options;
  options.relative_tolerance = 1e-11;
  options.absolute_tolerance = 1e-13;
  options.estimate_error = false;
  PidController c;
  c.proportional = 0.2;
  c.integral_per_s = 90.0;
  c.derivative_s = 1e-4;
  c.derivative_corner = Hertz{500.0};
  for (const Start start : {Start::zero, Start::equilibrium}) {
    options.start = start;
    for (const double period : {0.0, 1e-3, 4e-3, 2.5e-4}) {
      c.period_s = period;
      options.engine = Engine::cvode;
      const auto cvode = simulate_loop(plant, forward, c, r, options);
      options.engine = Engine::exact;
      const auto exact = simulate_loop(plant, forward, c, r, options);
      for (std::size_t i = 0; i < r.size(); ++i) {
        ASSERT_NEAR(cvode.y[i], exact.y[i], 1e-9) << period << " " << i;
        ASSERT_NEAR(cvode.drive[i], exact.drive[i], 1e-7) << period << " " << i;
      }
    }
  }
  // A limit that a sampled controller meets.
  c.period_s = 1e-3;
  c.upper = 0.05;
  options.engine = Engine::cvode;
  const auto cvode = simulate_loop(plant, forward, c, r, options);
  options.engine = Engine::exact;
  const auto exact = simulate_loop(plant, forward, c, r, options);
  for (std::size_t i = 0; i < r.size(); ++i) ASSERT_NEAR(cvode.y[i], exact.y[i], 1e-9) << i;
}

TEST(Feedback, ClosedFormRefusesWhatItCannotDo) {
  const auto r = constant(1.0, 1e-3, 50);
  Options options;
  options.engine = Engine::exact;
  PidController c;
  c.integral_per_s = 10.0;
  const Chain bent{{make_block("saturation").set("lower", -1.0).set("upper", 1.0),
                    make_block("lowpass").set("corner_hz", 10.0)}};
  const Chain linear{{make_block("lowpass").set("corner_hz", 10.0)}};
  EXPECT_THROW(simulate_loop(bent, std::nullopt, c, r, options), InputError);
  c.upper = 5.0;
  EXPECT_THROW(simulate_loop(linear, std::nullopt, c, r, options), InputError);
  c.period_s = 1.7e-3;  // no whole multiple of the step
  EXPECT_THROW(simulate_loop(linear, std::nullopt, c, r, options), InputError);
  options.engine = Engine::automatic;
  EXPECT_EQ(simulate_loop(linear, std::nullopt, c, r, options).stats.engine, Engine::cvode);
  EXPECT_EQ(simulate_loop(bent, std::nullopt, c, r, options).stats.engine, Engine::cvode);
  EXPECT_THROW(simulate_loop(linear, std::vector<double>(3, 0.0), c, r, options), InputError);
}

TEST(Feedback, HybridBeatsEitherAlone) {
  // A hysteretic stage: feed-forward of the rough inverse, feedback for the rest.
  Chain plant{{make_block("backlash").set("width", 0.1), make_block("lowpass").set("corner_hz", 400.0),
               make_block("gain").set("gain", 1.1)}};
  ReferenceSpec spec;
  spec.kind = "triangle";
  spec.frequency = Hertz{5.0};
  spec.duration_s = 0.4;
  spec.step_s = 5e-4;
  const auto r = make_reference(spec);
  PidController off;
  PidController pi;
  pi.proportional = 0.5;
  pi.integral_per_s = 150.0;
  const Chain forward{{make_block("gain").set("gain", 1.0)}};
  Options options;
  options.relative_tolerance = 1e-7;
  options.absolute_tolerance = 1e-9;
  options.estimate_error = false;
  const double open = error_figures(simulate_loop(plant, forward, off, r, options).y, r.u).rms_percent;
  const double back = error_figures(simulate_loop(plant, std::nullopt, pi, r, options).y, r.u).rms_percent;
  const auto both = simulate_loop(plant, forward, pi, r, options);
  const double hybrid = error_figures(both.y, r.u).rms_percent;
  EXPECT_LT(hybrid, back);
  EXPECT_LT(hybrid, open);
  EXPECT_EQ(both.drive.size(), r.size());
  // Open loop is the plain chain.
  Options plain;
  plain.engine = Engine::cvode;
  plain.estimate_error = false;
  const auto direct = simulate(plant, r, plain).y;
  const auto looped = simulate_loop(plant, forward, off, r, options).y;
  for (std::size_t i = 0; i < direct.size(); ++i) EXPECT_NEAR(direct[i], looped[i], 1e-6);
}

TEST(Feedback, LimitsHoldAndTheIntegralDoesNotWindUp) {
  const Chain plant{{make_block("lowpass").set("corner_hz", 10.0)}};
  PidController c;
  c.integral_per_s = 200.0;
  c.proportional = 1.0;
  c.upper = 0.5;
  TimeRecord r = constant(2.0, 1e-3, 800);
  for (std::size_t i = 400; i < 800; ++i) r.u[i] = 0.2;
  for (const double period : {0.0, 1e-3}) {
    c.period_s = period;
    const auto got = simulate_loop(plant, std::nullopt, c, r);
    EXPECT_NEAR(got.y[399], 0.5, 1e-3);
    EXPECT_LE(*std::max_element(got.drive.begin(), got.drive.end()), 0.5 + 1e-9);
    EXPECT_LT(got.y[450], 0.45);  // leaves the limit at once
    EXPECT_NEAR(got.y[799], 0.2, 1e-3);
  }
}

TEST(Feedback, RefusesWhatCannotBeALoop) {
  const auto r = constant(1.0, 1e-3, 10);
  EXPECT_THROW(simulate_loop(Chain{{make_block("gain")}}, std::nullopt, {}, r), DesignError);
  EXPECT_THROW(simulate_loop(Chain{{make_block("sample_hold").set("clock_hz", 1e3),
                                    make_block("lowpass").set("corner_hz", 10.0)}},
                             std::nullopt, {}, r),
               DesignError);
}

/// tau y' = u(t - T) - y, u' = ki (1 - y), step by step: the delay's input is known T before it is needed.
TEST(Feedback, ADelayStandsInTheLoop) {
  const double tau = 0.02;
  const double delay = 0.01;
  const double ki = 25.0;
  const Chain plant{{make_block("delay").set("delay_s", delay),
                     make_block("lowpass").set("corner_hz", 1.0 / (2.0 * std::numbers::pi * tau))}};
  PidController c;
  c.integral_per_s = ki;
  for (const Engine engine : {Engine::cvode, Engine::exact}) {
    Options options;
    options.engine = engine;
    const auto got = simulate_loop(plant, std::nullopt, c, constant(1.0, 1e-3, 301), options);
    ASSERT_EQ(got.notes.size(), 1u);
    EXPECT_NE(got.notes[0].find("the delay of 10 ms stands in the loop as an all-pass"), std::string::npos);
    constexpr double kStep = 1e-6;
    constexpr std::size_t late = 10000;  // steps of the delay
    std::vector<double> u{0.0};
    double y = 0.0;
    for (std::size_t i = 0; i < got.y.size() - 1; ++i) {
      EXPECT_NEAR(got.y[i], y, 2e-3) << i;
      for (int k = 0; k < 1000; ++k) {
        const double before = u.size() > late ? u[u.size() - 1 - late] : 0.0;
        u.push_back(u.back() + kStep * ki * (1.0 - y));
        y += kStep * (before - y) / tau;
      }
    }
  }
}

TEST(Feedback, AnIntegralThatSlidesAlongALimitIsFollowed) {
  // The error falls so fast that the control would leave the limit, and the integral brings it back.
  const double w1 = 2.0 * std::numbers::pi * 60.0, w2 = 2.0 * std::numbers::pi * 150.0;
  const Chain plant{
      {make_block("lowpass").set("corner_hz", 60.0), make_block("lowpass").set("corner_hz", 150.0)}};
  TimeRecord r;
  r.step_s = 1e-3;
  for (int i = 0; i < 400; ++i) r.u.push_back(0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * 3.3 * i * 1e-3));
  PidController c;
  c.proportional = 0.2;
  c.integral_per_s = 120.0;
  c.lower = -0.1;
  c.upper = 0.7;
  const auto got = simulate_loop(plant, std::nullopt, c, r).y;
  constexpr int kParts = 500;
  const double h = r.step_s / kParts;
  double x = 0.0, y = 0.0, integral = 0.0;
  for (std::size_t i = 0; i + 1 < r.size(); ++i) {
    EXPECT_NEAR(got[i], y, 2e-4) << i;
    for (int k = 0; k < kParts; ++k) {
      const double error = r.u[i] + (r.u[i + 1] - r.u[i]) * k / kParts - y;
      const double free = c.proportional * error + integral;
      if (!(free > c.upper && error > 0.0) && !(free < c.lower && error < 0.0))
        integral += h * c.integral_per_s * error;
      x += h * w1 * (std::clamp(free, c.lower, c.upper) - x);
      y += h * w2 * (x - y);
    }
  }
}

TEST(Feedback, ABlockThatJumpsAtTurnsIsTheLimitOfQuickControllers) {
  // Rising and falling polynomials differ where the drive turns: the loop turns it back soon, and again.
  const Chain plant{{make_block("polynomial_hysteresis")
                         .set("ascending", std::vector<double>{0.3546, -0.6433, 0.2887})
                         .set("descending", std::vector<double>{-0.2398, 0.0838, 0.156}),
                     make_block("lowpass").set("corner_hz", 1000.0),
                     make_block("resonator").set("natural_frequency_hz", 3000.0).set("damping_ratio", 0.3)}};
  ReferenceSpec spec;
  spec.frequency = Hertz{20.0};
  spec.duration_s = 0.04;
  spec.step_s = 1e-4;
  PidController c;
  c.proportional = 0.2;
  c.integral_per_s = 500.0;
  const auto r = make_reference(spec);
  const auto continuous = simulate_loop(plant, std::nullopt, c, r).y;
  double before = 0.1;
  for (const double period_s : {1e-4, 3e-5, 1e-5}) {
    c.period_s = period_s;
    const double off = error_figures(simulate_loop(plant, std::nullopt, c, r).y, continuous).max;
    EXPECT_LT(off, 0.5 * before);
    before = off;
  }
}

TEST(Feedback, HysteresisInASampledLoopIsItsOwnRecursion) {
  // Held drive, play, lag: between samples everything is a constant and an exponential.
  const double width = 0.1, tau = 0.004, period = 1e-3;
  const Chain plant{{make_block("backlash").set("width", width),
                     make_block("lowpass").set("corner_hz", 1.0 / (2.0 * std::numbers::pi * tau))}};
  PidController c;
  c.proportional = 0.4;
  c.integral_per_s = 80.0;
  c.period_s = period;
  ReferenceSpec spec;
  spec.frequency = Hertz{5.0};
  spec.duration_s = 0.5;
  spec.step_s = period;
  const auto r = make_reference(spec);
  Options options;
  options.relative_tolerance = 1e-11;
  options.absolute_tolerance = 1e-13;
  const auto got = simulate_loop(plant, std::nullopt, c, r, options);
  double y = 0.0, play = 0.0, integral = 0.0, last = r.u[0];
  const double a = std::exp(-period / tau);
  for (std::size_t k = 0; k < r.size(); ++k) {
    ASSERT_NEAR(got.y[k], y, 1e-9) << k;
    const double e = r.u[k] - y;
    if (k > 0) integral += 80.0 * period * 0.5 * (e + last);
    last = e;
    const double u = 0.4 * e + integral;
    play = std::clamp(play, u - 0.5 * width, u + 0.5 * width);
    y = a * y + (1.0 - a) * play;
  }
}

}  // namespace
}  // namespace bodesmith::simulate
