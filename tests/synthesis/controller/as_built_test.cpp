// References as sources of a deck, and the whole controller in time.
#include "synthesis/controller/as_built.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <sstream>

#include "base/error.hpp"
#include "synthesis/controller/study.hpp"
#include "synthesis/generator/at_rest.hpp"
#include "texts.hpp"

namespace bodesmith::generator {
namespace {

using tracking::Reference;

/// The volts of a deck's sources between `node` and ground, at t.
double volts_of(const std::string& deck, double t) {
  double sum = 0.0;
  for (const auto& sine : matches(deck, R"(SIN\((\S+) (\S+) (\S+) 0 0 (\S+)\))"))
    sum += std::stod(sine[1]) + std::stod(sine[2]) * std::sin(2.0 * M_PI * std::stod(sine[3]) * t +
                                                              M_PI / 180.0 * std::stod(sine[4]));
  const auto list = deck.find("PWL(");
  if (list == std::string::npos) return sum;
  std::map<double, double> points;
  std::string text = deck.substr(list + 4);
  for (char& c : text) c = c == '+' || c == ')' ? ' ' : c;
  std::istringstream in(text);
  double time = 0.0, v = 0.0;
  while (in >> time >> v) points[time] = v;
  const auto above = points.lower_bound(t);
  if (above == points.begin()) return sum + above->second;
  if (above == points.end()) return sum + points.rbegin()->second;
  const auto below = std::prev(above);
  return sum + below->second +
         (above->second - below->second) * (t - below->first) / (above->first - below->first);
}

TEST(ReferenceSources, MakeTheReferenceFromAnyPhaseOn) {
  for (const Reference::Shape shape : {Reference::Shape::triangle, Reference::Shape::sine,
                                       Reference::Shape::two_tone, Reference::Shape::decaying_triangle}) {
    for (const double alpha : {1.0, 0.4}) {
      for (const double start : {0.0, 0.3, 1.75}) {
        const Reference reference(shape, alpha);
        const Hertz f{40.0};
        const double repeat = static_cast<double>(reference.periods()) / f.value;
        const std::string deck = reference_sources(reference, f, start, start + 2.0);
        const std::string rising = rising_source(reference, f, start, start + 2.0);
        for (double phase = start + 0.013; phase < start + 1.99; phase += 0.0717) {
          const double t = (phase - start) * repeat, theta = phase - std::floor(phase);
          EXPECT_NEAR(volts_of(deck, t), reference.value(theta), 1e-9) << phase << deck;
          EXPECT_NEAR(volts_of(rising, t), Reference::rises(reference.piece(theta)) ? 1.0 : 0.0, 1e-9)
              << phase << rising;
        }
      }
    }
  }
}

Disturbance with_rates() {
  Disturbance out;
  out.ascending = {0.3546, -0.6433, 0.2887};
  out.descending = {-0.2398, 0.0838, 0.156};
  out.rate.frequency = {Hertz{1}, Hertz{10}, Hertz{100}};
  out.rate.ascending = {1, 1, 1};
  out.rate.descending = {1, 1.06, 1.17};
  return out;
}

TEST(AsBuilt, OneRepeatInCvodeIsTheReferenceLessWhatTheStageAdds) {
  const DisturbanceCircuit circuit = make_controller(with_rates());
  const Reference triangle;
  constexpr std::size_t kSamples = 512;
  const std::vector<double> instants = {0.0, 1e-3, 4.5e-3};
  const SteadyState run = run_in_cvode(circuit, triangle, Hertz{100.0}, kSamples, instants);
  ASSERT_EQ(run.v.size(), kSamples);
  ASSERT_EQ(run.own_v.size(), instants.size());
  EXPECT_NEAR(run.period_s(), 0.01, 1e-12);
  for (std::size_t i = 0; i < kSamples; ++i)
    EXPECT_NEAR(run.r[i], triangle.value(static_cast<double>(i) / kSamples), 1e-9) << i;
  for (std::size_t k = 1; k < instants.size(); ++k) {
    const double at = instants[k] / run.step_s;
    const auto i = static_cast<std::size_t>(at);
    EXPECT_NEAR(run.own_v[k], run.v[i] + (at - static_cast<double>(i)) * (run.v[i + 1] - run.v[i]), 1e-4);
  }
  const tracking::TrackingError error = stage_error(circuit, run);
  EXPECT_LT(error.rms_percent, 0.05);
  EXPECT_NEAR(error.range, 1.0, 1e-3);
}

TEST(AsBuilt, SettlesForTenTimeConstantsOfTheSmoothing) {
  const DisturbanceCircuit circuit = make_controller(with_rates());
  ASSERT_TRUE(circuit.slope);
  const double tau = SlopeMeterGains::of(circuit, schematic::Deviations::none(circuit)).smoothing_s;
  EXPECT_NEAR(tau, circuit.slope->smoothing_s, 0.1 * tau);
  EXPECT_EQ(repeats_to_settle(circuit, 20.0 * circuit.slope->smoothing_s), 1);
  EXPECT_EQ(repeats_to_settle(circuit, 4.0 * circuit.slope->smoothing_s), 3);
  EXPECT_EQ(repeats_to_settle(circuit, 1e-3 * circuit.slope->smoothing_s), 20);
  EXPECT_EQ(NgspiceRun::of_one(Reference()).samples, NgspiceRun::of_many().samples);
  EXPECT_EQ(NgspiceRun::of_one(Reference(Reference::Shape::triangle, 0.5)).samples,
            8 * NgspiceRun::of_many().samples);
  EXPECT_EQ(NgspiceRun::of_one(Reference(Reference::Shape::sine, 1.0)).samples,
            8 * NgspiceRun::of_many().samples);
}

TEST(AsBuilt, TheSwitchIsLateByDetectorAndSwitch) {
  const DisturbanceCircuit circuit = make_controller(with_rates());
  const double slow = switch_delay_s(circuit, Reference(), Hertz{100.0});
  const double fast = switch_delay_s(circuit, Reference(), Hertz{1000.0});
  EXPECT_GT(slow, circuit.analog_switch.on_delay_s);
  EXPECT_GT(slow, fast) << "the steeper slope is told earlier";
  EXPECT_LT(slow, 1e-4);
  EXPECT_THROW(switch_delay_s(circuit, Reference(), Hertz{1e-6}), InputError);
}

}  // namespace
}  // namespace bodesmith::generator
