// What the input does between the samples of a record.
#include "gap/search/between_samples.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "gap/made_model.hpp"
#include "gap/runner.hpp"
#include "simulate/record/record_simulator.hpp"

namespace {

using namespace bodesmith;

constexpr double kStep = 1e-3;
constexpr double kCorner = 80.0;

chain::Chain low_pass() {
  return model_of("[[block]]\ntype = \"lowpass\"\ncorner_hz = 75.0\nfree = [\"corner_hz\"]\n");
}

/// Sines up to a sixth of the sampling rate; the output as they pass a low pass (`smooth`: as curves, else as straight
/// lines between the samples), and a little noise.
gap::Experiments record_of_sines(bool smooth) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> phase(0.0, 2.0 * std::numbers::pi);
  TimeRecord r;
  r.file = "record.csv";
  r.step_s = kStep;
  r.u.assign(900, 0.0);
  r.y.assign(900, 0.0);
  for (double hz = 20.0; hz < 170.0; hz += 20.0) {
    const auto h = 1.0 / std::complex<double>(1.0, hz / kCorner);
    const double start = phase(random);
    for (std::size_t i = 0; i < r.size(); ++i) {
      const double angle = 2.0 * std::numbers::pi * hz * r.time_s(i) + start;
      r.u[i] += std::sin(angle);
      r.y[i] += std::abs(h) * std::sin(angle + std::arg(h));
    }
  }
  if (!smooth) {
    auto chain = low_pass();
    chain.blocks[0].set("corner_hz", kCorner);
    r.y = simulate::RecordSimulator(std::move(chain), kStep).run_once(r.u);
  }
  for (double& y : r.y) y += 1e-3 * normal(random);
  gap::TimeExperiment experiment(std::move(r), 300);
  experiment.leave_out_start();
  return {experiment};
}

/// The low pass fitted with straight lines, and with the block in front when that helps; what each leaves.
struct Fits {
  double straight = 0.0;
  double smooth = 0.0;  ///< 0: the block was not put in
};
Fits fits_of(bool smooth) {
  const gap::SearchOptions options;
  const gap::Model initial(low_pass());
  const gap::SearchSetting setting{options};
  const gap::SearchRecords records{record_of_sines(smooth), {}};
  const auto model = gap::fit(initial, records.train).model;
  Fits fits{gap::rms_of(model, records.train), 0.0};
  if (const auto corrected = gap::with_smooth_input(setting, records, model)) {
    EXPECT_EQ(corrected->terms().size(), 0U);
    fits.smooth = gap::rms_of(*corrected, records.train);
  }
  return fits;
}

TEST(BetweenSamples, ASmoothInputBulgesOutOfTheLines) {
  const auto fits = fits_of(true);
  EXPECT_GT(fits.straight, 0.005);
  ASSERT_GT(fits.smooth, 0.0);
  EXPECT_LT(fits.smooth, 0.5 * fits.straight);
}

TEST(BetweenSamples, AStraightOneIsLeftAlone) {
  const auto fits = fits_of(false);
  EXPECT_LT(fits.straight, 0.0012);
  EXPECT_EQ(fits.smooth, 0.0);
}

}  // namespace
