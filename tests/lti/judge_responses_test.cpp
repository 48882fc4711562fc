#include "lti/judge_responses.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lti/bulk_response.hpp"
#include "lti/steep_flanks.hpp"

namespace bodesmith {
namespace {

Responses of(const Sections& sections) {
  return [sections](const std::vector<Hertz>& grid) { return responses(sections, grid); };
}

/// Corners in Hz; damping 0 of the zeros is a notch on the axis.
Sections biquad(double zero_hz, double zero_damping, double pole_hz, double pole_damping) {
  const auto pair = [](double hz, double damping) {
    const double w = Hertz{hz}.rad_s().value;
    const std::complex<double> root(-damping * w, w * std::sqrt(1.0 - damping * damping));
    return std::vector<std::complex<double>>{root, std::conj(root)};
  };
  Sections out;
  out.sections = {{1.0, pair(zero_hz, zero_damping), pair(pole_hz, pole_damping)}};
  return out;
}

ResponseDifference on_dense_grid(const Sections& got, const Sections& wanted, Band band) {
  const std::vector<Hertz> grid = log_grid(band, 400001);
  return compare_responses(grid, responses(got, grid), responses(wanted, grid));
}

TEST(JudgeResponses, FindsWhatADenseGridFinds) {
  const Band band{Hertz{10.0}, Hertz{10000.0}};
  const Sections wanted = biquad(400.0, 0.4, 700.0, 0.1);
  for (const double off : {1.001, 1.01, 1.03}) {
    const Sections got = biquad(400.0 / off, 0.4, 700.0 * off, 0.1);
    const ResponseDifference judged = judge_responses(of(got), of(wanted), band);
    const ResponseDifference dense = on_dense_grid(got, wanted, band);
    EXPECT_NEAR(judged.max_magnitude_db, dense.max_magnitude_db, 2e-4 * dense.max_magnitude_db) << off;
    EXPECT_NEAR(judged.max_phase_deg, dense.max_phase_deg, 2e-4 * dense.max_phase_deg) << off;
    EXPECT_NEAR(judged.max_complex_percent, dense.max_complex_percent, 2e-4 * dense.max_complex_percent)
        << off;
  }
}

TEST(JudgeResponses, SmoothCurvesAreComparedAtEachFrequency) {
  const Band band{Hertz{10.0}, Hertz{10000.0}};
  const Sections wanted = biquad(300.0, 0.8, 900.0, 0.7);
  const Sections got = biquad(310.0, 0.8, 900.0, 0.6);
  double level = 0.0;
  double angle = 0.0;
  for (const Hertz f : log_grid(band, 100001)) {
    const std::complex<double> ratio = got.response(f.rad_s()) / wanted.response(f.rad_s());
    level = std::max(level, std::abs(to_decibel(std::abs(ratio))));
    angle = std::max(angle, std::abs(to_degrees(std::arg(ratio))));
  }
  const ResponseDifference judged = judge_responses(of(got), of(wanted), band);
  EXPECT_NEAR(judged.max_magnitude_db, level, 1e-4 * level);
  EXPECT_NEAR(judged.max_phase_deg, angle, 1e-4 * angle);
  const auto one_by_one = [](const Sections& h) {
    return at_each([h](RadPerSecond w) { return h.response(w); });
  };
  EXPECT_NEAR(judge_responses(one_by_one(got), one_by_one(wanted), band).max_magnitude_db,
              judged.max_magnitude_db, 1e-9);
  EXPECT_FALSE(has_flanks([&](Hertz f) { return wanted.response(f.rad_s()); }, band));
}

/// A whole response moved sideways by a share of a percent is off by as many decibels, however steep it is; what straight
/// lines between points cost is a part in thirty, and a tenth of a degree where the angle turns below the floor.
TEST(JudgeResponses, AMovedNotchIsOffByItsShift) {
  const Band band{Hertz{20.0}, Hertz{125.0}};
  const Sections wanted = biquad(50.0, 0.0, 50.0, 0.1);
  EXPECT_TRUE(has_flanks([&](Hertz f) { return wanted.response(f.rad_s()); }, band));
  for (const double percent : {0.05, 0.3, 1.0}) {
    const double by = std::exp(percent / 100.0);
    const Sections got = biquad(50.0 * by, 0.0, 50.0 * by, 0.1);
    const ResponseDifference judged = judge_responses(of(got), of(wanted), band);
    EXPECT_LE(judged.max_magnitude_db, 1.03 * percent) << percent;
    EXPECT_GE(judged.max_magnitude_db, 0.5 * percent) << percent;
    EXPECT_LE(judged.max_phase_deg, 1.03 * 6.6 * percent + 0.1) << percent;
  }
}

TEST(JudgeResponses, ANotchThatIsMissingIsSaid) {
  const Band band{Hertz{20.0}, Hertz{125.0}};
  const Sections wanted = biquad(50.0, 0.0, 50.0, 0.1);
  const Sections flat = biquad(50.0, 0.1, 50.0, 0.1);
  EXPECT_GT(judge_responses(of(flat), of(wanted), band).max_magnitude_db, 8.0);
}

/// Q/sqrt(1 - 1/(4 Q^2)), from five points a decade that miss it.
TEST(RefinedMaximum, FindsTheTopOfAResonance) {
  for (const double q : {1.0, 5.0, 20.0}) {
    const double top = refined_maximum(log_grid({Hertz{1.0}, Hertz{1e4}}, 61), [&](Hertz f) {
      const std::complex<double> r(0.0, f.value / 137.0);
      return std::abs(1.0 / (1.0 + r / q + r * r));
    });
    EXPECT_NEAR(top / (q / std::sqrt(1.0 - 0.25 / (q * q))), 1.0, q > 10.0 ? 0.02 : 1e-3) << q;
  }
  EXPECT_EQ(refined_maximum({}, [](Hertz) { return 1.0; }), 0.0);
  EXPECT_EQ(around_peaks({Hertz{1.0}, Hertz{4.0}, Hertz{9.0}}, {1.0, 3.0, 2.0}),
            (std::vector<Hertz>{Hertz{2.0}, Hertz{6.0}}));
  EXPECT_EQ(around_peaks({Hertz{1.0}, Hertz{4.0}, Hertz{9.0}}, {5.0, 3.0, 2.0}),
            std::vector<Hertz>{Hertz{2.0}});
  EXPECT_EQ(around_peaks({Hertz{1.0}, Hertz{4.0}, Hertz{9.0}}, {2.0, 3.0, 5.0}),
            std::vector<Hertz>{Hertz{6.0}});
}

}  // namespace
}  // namespace bodesmith
