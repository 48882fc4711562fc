// Measured responses made from known poles and zeros with normal noise: order, roots and their stated deviations.
#include "fit/measured/measured_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "lti/section_making.hpp"
#include "numeric/random.hpp"

namespace bodesmith {
namespace {

using Complex = std::complex<double>;

std::vector<Complex> pair_at(double hz, double damping) {
  const double w = Hertz{hz}.rad_s().value;
  const Complex root(-damping * w, w * std::sqrt(1.0 - damping * damping));
  return {root, std::conj(root)};
}

Complex real_at(double hz) {
  return {-Hertz{hz}.rad_s().value, 0.0};
}

/// A stage with two modes, an antiresonance between them and a lag.
Sections two_modes() {
  std::vector<Complex> poles = pair_at(900.0, 0.01);
  for (const Complex& p : pair_at(2500.0, 0.03)) poles.push_back(p);
  poles.push_back(real_at(6000.0));
  std::vector<Complex> zeros = pair_at(1500.0, 0.02);
  zeros.push_back(-real_at(8000.0));  // right half plane
  Sections out = make_sections(1.0, zeros, poles);
  out.gain /= out.dc_gain();
  return out;
}

FrequencyRecord measured(const Sections& truth, std::size_t count, double noise, std::uint64_t seed) {
  FrequencyRecord out;
  out.file = "made.csv";
  Random random(seed);
  out.frequency = log_grid({Hertz{10.0}, Hertz{2e4}}, static_cast<int>(count));
  for (const Hertz f : out.frequency) {
    const Complex h = truth.response(f.rad_s());
    const double size = noise * (0.02 + std::abs(h)) / std::sqrt(2.0);
    const double re = random.normal();
    out.response.push_back(h + size * Complex(re, random.normal()));
  }
  return out;
}

TEST(MeasuredFit, FindsOrderDelayAndRootsWithinTheirDeviations) {
  Sections truth = two_modes();
  truth.delay_s = 20e-6;
  const MeasuredFit fit = fit_measured(measured(truth, 600, 0.01, 7), {});
  EXPECT_EQ(fit.order, 5);
  EXPECT_NEAR(fit.delay_s, 20e-6, 5.0 * fit.delay_deviation_s);
  EXPECT_GT(fit.delay_deviation_s, 0.0);
  EXPECT_LT(fit.delay_deviation_s, 1e-6);
  int found = 0;
  for (const auto& [hz, damping] : {std::pair{900.0, 0.01}, {2500.0, 0.03}}) {
    for (const MeasuredFit::Root& pole : fit.poles) {
      if (!pole.pair || std::abs(pole.frequency.value / hz - 1.0) > 0.05) continue;
      ++found;
      EXPECT_NEAR(pole.frequency.value, hz, 5.0 * pole.frequency_deviation.value);
      EXPECT_NEAR(pole.damping, damping, 5.0 * pole.damping_deviation);
      EXPECT_LT(pole.frequency_deviation.value, 1e-3 * hz);
    }
  }
  EXPECT_EQ(found, 2);
  const auto right = std::count_if(fit.zeros.begin(), fit.zeros.end(),
                                   [](const MeasuredFit::Root& zero) { return zero.frequency.value < 0.0; });
  EXPECT_EQ(right, 1);
  EXPECT_NEAR(fit.rms_noise, 1.0, 0.3);
  ASSERT_FALSE(fit.orders.empty());
  // Three digits of what each order leaves: further ones are the compiler's.
  const Json told = fit.report_json()["orders"];
  for (std::size_t i = 0; i < told.size(); ++i) {
    const double held_out = told[i]["held_out"];
    EXPECT_NEAR(held_out / fit.orders[i].held_out, 1.0, 5e-3);
    EXPECT_EQ(rounded_text(held_out, 3), rounded_text(held_out, 12));
    EXPECT_NEAR(told[i]["standard_errors_above_best"].get<double>(), fit.orders[i].against_best,
                5e-3 * fit.orders[i].against_best);
  }
}

/// Roots, delay and their deviations go with the unit of time and the gain with that of the output; all else stays, words too. The
/// record has a pole that its noise hardly lets be seen.
TEST(MeasuredFit, UnitsOfTimeAndOutputChangeNothing) {
  Sections truth = two_modes();
  truth.delay_s = 20e-6;
  const FrequencyRecord record = measured(truth, 150, 0.15, 11);
  MeasuredFitOptions options;
  options.order = 6;
  const MeasuredFit here = fit_measured(record, options);
  constexpr double kTime = 1024.0, kOutput = 1.0 / 64.0;
  FrequencyRecord other = record;
  for (Hertz& f : other.frequency) f.value *= kTime;
  for (Complex& h : other.response) h *= kOutput;
  const MeasuredFit there = fit_measured(other, options);
  EXPECT_NEAR(there.delay_s * kTime, here.delay_s, 1e-3 * here.delay_deviation_s);
  EXPECT_NEAR(there.delay_deviation_s * kTime, here.delay_deviation_s, 1e-3 * here.delay_deviation_s);
  ASSERT_EQ(there.poles.size(), here.poles.size());
  ASSERT_EQ(there.zeros.size(), here.zeros.size());
  for (const auto roots : {&MeasuredFit::poles, &MeasuredFit::zeros}) {
    for (std::size_t i = 0; i < (here.*roots).size(); ++i) {
      const MeasuredFit::Root& a = (here.*roots)[i];
      const MeasuredFit::Root& b = (there.*roots)[i];
      EXPECT_NEAR(b.frequency.value / kTime, a.frequency.value, 1e-3 * std::abs(a.frequency.value));
      EXPECT_NEAR(b.frequency_deviation.value / kTime, a.frequency_deviation.value,
                  1e-2 * a.frequency_deviation.value);
      EXPECT_NEAR(b.damping, a.damping, 1e-3);
    }
  }
  EXPECT_NEAR(there.rms_db, here.rms_db, 1e-4);
  EXPECT_NEAR(there.max_db, here.max_db, 1e-3);
  EXPECT_NEAR(there.rms_percent, here.rms_percent, 1e-3 * here.rms_percent);
  EXPECT_NEAR(there.noise_percent, here.noise_percent, 1e-3 * here.noise_percent);
  EXPECT_NEAR(there.rms_noise, here.rms_noise, 1e-3);
  EXPECT_EQ(there.warnings.size(), here.warnings.size());
  // A pole is hardly determined when half its frequency or more is not known.
  std::size_t hardly = 0;
  for (const MeasuredFit::Root& pole : here.poles) {
    const double percent = 100.0 * pole.frequency_deviation.value / std::abs(pole.frequency.value);
    const bool warned = std::any_of(here.warnings.begin(), here.warnings.end(), [&](const std::string& one) {
      return one.find("the pole at " + engineering_text(pole.frequency.value, "Hz") +
                      " is hardly determined (" + rounded_text(percent, 2) + " %") != std::string::npos;
    });
    EXPECT_EQ(warned, percent > 50.0) << percent;
    hardly += warned ? 1 : 0;
  }
  EXPECT_GT(hardly, 0u);
}

TEST(MeasuredFit, DeviationsAreThoseOfRepeatedMeasurements) {
  const Sections truth = two_modes();
  MeasuredFitOptions options;
  options.order = 5;
  options.delay = false;
  double square = 0.0;
  double stated = 0.0;
  const int repeats = 24;
  for (int i = 0; i < repeats; ++i) {
    const MeasuredFit fit =
        fit_measured(measured(truth, 300, 0.02, 100 + static_cast<std::uint64_t>(i)), options);
    for (const MeasuredFit::Root& pole : fit.poles) {
      if (std::abs(pole.frequency.value - 900.0) > 50.0) continue;
      square += std::pow(pole.frequency.value - 900.0, 2) / repeats;
      stated += pole.frequency_deviation.value / repeats;
    }
  }
  EXPECT_GT(std::sqrt(square) / stated, 0.6);
  EXPECT_LT(std::sqrt(square) / stated, 1.6);
}

/// Noise that is ten times as great above 4 kHz says nothing of a mode far below: it is looked for where it is.
TEST(MeasuredFit, NoiseElsewhereLeavesADeviationAsItIs) {
  const Sections truth = two_modes();
  FrequencyRecord quiet = measured(truth, 600, 0.01, 21);
  FrequencyRecord loud = quiet;
  for (std::size_t i = 0; i < loud.response.size(); ++i) {
    const Complex h = truth.response(loud.frequency[i].rad_s());
    if (loud.frequency[i].value > 4e3) loud.response[i] = h + 10.0 * (loud.response[i] - h);
  }
  MeasuredFitOptions options;
  options.order = 5;
  options.delay = false;
  const auto of_first_mode = [&](const FrequencyRecord& record) {
    for (const MeasuredFit::Root& pole : fit_measured(record, options).poles) {
      if (std::abs(pole.frequency.value - 900.0) < 20.0) return pole.frequency_deviation.value;
    }
    return 0.0;
  };
  const double alone = of_first_mode(quiet);
  EXPECT_GT(alone, 0.0);
  EXPECT_NEAR(of_first_mode(loud) / alone, 1.0, 0.5);
}

TEST(MeasuredFit, WithoutNoiseTheResponseIsMetExactly) {
  MeasuredFitOptions options;
  options.order = 5;
  options.delay = false;
  const MeasuredFit fit = fit_measured(measured(two_modes(), 200, 0.0, 1), options);
  EXPECT_LT(fit.max_db, 1e-6);
}

// s^2 + 2 damping frequency s + frequency^2 is 0 at them.
TEST(FactoredResponse, RootsOfAPairAreThoseOfItsQuadratic) {
  for (const double damping : {-1.7, -0.3, 0.02, 0.8, 1.0, 1.3, 40.0}) {
    FactoredResponse::Factor pair;
    pair.pair = true;
    pair.frequency = 3.0;
    pair.damping = damping;
    const auto roots = pair.roots();
    ASSERT_EQ(roots.size(), 2u);
    EXPECT_NEAR(std::abs(roots[0] + roots[1] + 6.0 * damping), 0.0, 1e-13 * (1.0 + std::abs(damping)))
        << damping;
    EXPECT_NEAR(std::abs(roots[0] * roots[1] - 9.0), 0.0, 1e-13) << damping;
  }
}

TEST(MeasuredFit, ManyPolesInManyPoints) {
  std::vector<Complex> poles;
  std::vector<Complex> zeros;
  for (int i = 0; i < 10; ++i) {
    const double hz = 40.0 * std::pow(1.7, i);
    for (const Complex& p : pair_at(hz, 0.01 + 0.004 * i)) poles.push_back(p);
    if (i < 9) {
      for (const Complex& z : pair_at(1.3 * hz, 0.02)) zeros.push_back(z);
    }
  }
  Sections truth = make_sections(1.0, zeros, poles);
  truth.gain /= truth.dc_gain();
  MeasuredFitOptions options;
  options.order = 20;
  options.delay = false;
  const MeasuredFit fit = fit_measured(measured(truth, 2000, 0.01, 3), options);
  EXPECT_EQ(fit.order, 20);
  EXPECT_NEAR(fit.rms_noise, 1.0, 0.3);
}

TEST(MeasuredFit, KeepsItsDelayInTheFile) {
  Sections sections = two_modes();
  sections.delay_s = 1e-3;
  const Complex h = sections.response(Hertz{100.0}.rad_s());
  const Sections read = Sections::from_node(parse_json(
      [&] {
        Json json = sections.to_json();
        json["schema"] = "bodesmith.sections/1";
        return json.dump();
      }(),
      "s.json"));
  EXPECT_NEAR(std::abs(read.response(Hertz{100.0}.rad_s()) - h), 0.0, 1e-12);
  EXPECT_EQ(read.delay_s, 1e-3);
}

// A circuit would be built for a corner far below the band, or for none.
TEST(MeasuredFit, ZerosThatCannotBeToldFromRestAreThere) {
  for (const std::size_t zeros_at_rest : {std::size_t{1}, std::size_t{2}}) {
    std::vector<Complex> poles = pair_at(900.0, 0.2);
    poles.push_back(real_at(60.0));
    const Sections truth = make_sections(1e6, std::vector<Complex>(zeros_at_rest), poles);
    FrequencyRecord record = measured(truth, 120, 0.0, 3);
    Random random(5);
    for (Complex& h : record.response) {
      const double re = random.normal();
      h *= 1.0 + 0.004 * Complex(re, random.normal());
    }
    const MeasuredFit fit = fit_measured(record, {});
    EXPECT_EQ(fit.order, 3);
    ASSERT_EQ(fit.zeros.size(), zeros_at_rest);
    for (const MeasuredFit::Root& zero : fit.zeros) EXPECT_EQ(zero.frequency.value, 0.0);
    EXPECT_EQ(fit.sections.dc_gain(), 0.0);
    EXPECT_LT(fit.rms_db, 0.06);
  }
  // One that can be told stays.
  std::vector<Complex> poles = pair_at(900.0, 0.2);
  poles.push_back(real_at(60.0));
  const Sections truth = make_sections(1e6, {real_at(6.0)}, poles);
  const MeasuredFit fit = fit_measured(measured(truth, 120, 0.004, 3), {});
  ASSERT_EQ(fit.zeros.size(), 1u);
  EXPECT_NEAR(fit.zeros[0].frequency.value, 6.0, 5.0 * fit.zeros[0].frequency_deviation.value);
}

TEST(MeasuredFit, RefusesWhatDeterminesNothing) {
  FrequencyRecord record = measured(two_modes(), 5, 0.0, 1);
  EXPECT_THROW(fit_measured(record, {}), InputError);
  record = measured(two_modes(), 20, 0.0, 1);
  MeasuredFitOptions options;
  options.order = 12;
  EXPECT_THROW(fit_measured(record, options), InputError);
  for (Complex& h : record.response) h = 0.0;
  EXPECT_THROW(fit_measured(record, {}), InputError);
}

}  // namespace
}  // namespace bodesmith
