#include "fit/waveform/waveform_fit.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "fit/paper_disturbance.hpp"
#include "fit/waveform/waveform_problem.hpp"

namespace bodesmith {
namespace {

// The best that long searches found with real sections: percent of range.
TEST(WaveformFit, ReachesTheBestKnownErrors) {
  struct Known {
    int order;
    double rms;
    double worst;
  };
  for (const Known& known : {Known{1, 0.242, 0.322}, Known{2, 0.227, 0.266}, Known{4, 0.176, 0.215}}) {
    const auto rms = fit_waveform(both_driven(), {.order = known.order});
    EXPECT_LT(rms.error.rms_percent, 1.02 * known.rms) << known.order;
    const auto worst = fit_waveform(both_driven(), {.order = known.order, .worst = true});
    EXPECT_LT(worst.error.worst_percent, 1.02 * known.worst) << known.order;
    for (const WaveformFit* fit : {&rms, &worst}) {
      EXPECT_EQ(fit->sections.pole_count(), known.order);
      double db = 0.0, deg = 0.0;  // against the gains themselves
      for (const Hertz f : both_driven().rate.frequency) {
        const auto quotient =
            fit->sections.response(f.rad_s()) / both_driven().rate_gain(Disturbance::Branch::ascending, f);
        db = std::max(db, 20.0 * std::abs(std::log10(std::abs(quotient))));
        deg = std::max(deg, std::abs(std::arg(quotient)) * 180.0 / M_PI);
      }
      ASSERT_TRUE(fit->sections.error);
      EXPECT_NEAR(fit->sections.error->max_magnitude_db, db, 1e-9);
      EXPECT_NEAR(fit->sections.error->max_phase_deg.value(), deg, 1e-9);
      for (const Section& section : fit->sections.sections) {
        EXPECT_TRUE(section.is_stable());
        for (const auto& pole : section.poles) EXPECT_EQ(pole.imag(), 0.0);
      }
      EXPECT_NEAR(fit->magnitude_only.points.back().rms_percent, 1.40, 0.01);
      EXPECT_NEAR(fit->none.points.back().rms_percent, 0.847, 0.001);
      EXPECT_LT(fit->lower_bound_percent, fit == &worst ? fit->error.worst_percent : fit->error.rms_percent);
      // In between, where nothing was asked: no worse than doing nothing.
      const auto at = waveform_error([&](RadPerSecond w) { return fit->sections.response(w); }, both_driven(),
                                     {Hertz{40}, Hertz{80}});
      const auto none =
          waveform_error([](RadPerSecond) { return 1.0; }, both_driven(), {Hertz{40}, Hertz{80}});
      for (size_t i = 0; i < 2; ++i) EXPECT_LT(at.points[i].rms_percent, none.points[i].rms_percent);
    }
  }
}

TEST(WaveformFit, FixedGainInClosedForm) {
  const auto rms = fit_waveform(both_driven(), {.order = 1});
  EXPECT_NEAR(rms.constant_gain, (1 + 1.06 + 1.1 + 1.04 + 1.17) / 5, 1e-4);
  const auto worst = fit_waveform(both_driven(), {.order = 1, .worst = true});
  EXPECT_NEAR(worst.constant_gain, 1.085, 1e-4);
}

TEST(WaveformFit, LowerBoundHoldsAndIsZeroWhenAFilterCanDoIt) {
  // Harmonics of 10 and 17 Hz meet only far up: a filter can give each its own gain.
  Disturbance d = both_driven();
  d.rate.frequency = {Hertz{10.0}, Hertz{17.000137}};
  d.rate.ascending = d.rate.descending = {1.0, 1.2};
  // Only the mean value, which all frequencies share, is left.
  const double shared = waveform_lower_bound(d, d.rate.frequency, DrivenPath::whole, false);
  EXPECT_LT(shared, 0.2);
  for (const bool worst : {false, true}) {
    const double bound = waveform_lower_bound(both_driven(), {}, DrivenPath::whole, worst);
    EXPECT_LT(bound, worst ? 0.215 : 0.176);
    EXPECT_GT(bound, 0.03);
  }
}

TEST(WaveformFit, OneBranchInItsOwnPath) {
  Disturbance d = both_driven();
  d.rate.ascending = {1, 1, 1, 1, 1};
  EXPECT_EQ(path_to_compensate(d), DrivenPath::descending);
  EXPECT_EQ(path_to_compensate(both_driven()), DrivenPath::whole);
  const auto fit = fit_waveform(d, {.order = 2, .path = DrivenPath::descending});
  EXPECT_LT(fit.error.rms_percent, fit.constant.rms_percent);
  EXPECT_LT(fit.constant.rms_percent, fit.none.rms_percent);
  d.rate.ascending = {1, 1, 1, 1, 1.1};
  EXPECT_THROW(path_to_compensate(d), InputError);
}

TEST(WaveformFit, DampedPairsAreDamped) {
  const auto fit = fit_waveform(both_driven(), {.order = 2, .real = false});
  EXPECT_LE(fit.error.rms_percent, 0.2275);
  for (const Section& section : fit.sections.sections) {
    for (const auto& pole : section.poles) EXPECT_GE(-pole.real() / std::abs(pole), 0.5 - 1e-9);
  }
}

TEST(WaveformFit, RefusesWhatNeedsNoFilter) {
  Disturbance d = both_driven();
  EXPECT_THROW(fit_waveform(d, {.order = 0}), InputError);
  EXPECT_THROW(fit_waveform(d, {.order = 7}), InputError);
  d.rate = {};
  EXPECT_THROW(fit_waveform(d, {.order = 2}), InputError);
  EXPECT_THROW(path_to_compensate(d), InputError);
}

TEST(WaveformFit, NoFiniteCandidateIsRefused) {
  Disturbance d;
  d.ascending = {0.3546, -0.6433, 0.2887};
  d.descending = {-0.2398, 0.0838, 0.156};
  d.rate = {{Hertz{1.0}, Hertz{10.0}}, {1.0, 1e300}, {1.0, 1e300}};
  EXPECT_THROW(fit_waveform(d, {.order = 1}), DesignError);
}

}  // namespace
}  // namespace bodesmith
