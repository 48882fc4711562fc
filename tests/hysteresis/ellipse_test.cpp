#include "hysteresis/ellipse.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "hysteresis/model_type.hpp"
#include "test_signals.hpp"

namespace bodesmith::hysteresis {
namespace {

/// u and y of eq. 2: gain and phase fall with frequency and rise with amplitude.
TimeRecord ellipse_record(double amplitude, double f, double step_s, double periods) {
  const double gain = 0.4 + 0.002 * amplitude - 0.03 * std::log10(f);
  const double phase = -0.1 - 0.02 * std::log10(f) - 0.001 * amplitude;
  std::vector<double> u, y;
  for (int i = 0; i < static_cast<int>(periods / (f * step_s)); ++i) {
    const double angle = 2 * std::numbers::pi * f * step_s * i - std::numbers::pi / 2;
    u.push_back(75 + amplitude * std::sin(angle));
    y.push_back(30 + gain * amplitude * std::sin(angle + phase));
  }
  return testing::record(u, y, step_s);
}

TEST(Ellipse, IdentifiesTheSurfacesAndFollowsThem) {
  std::vector<TimeRecord> records;
  for (const double f : {1.0, 10.0, 100.0})
    for (const double a : {10.0, 30.0, 60.0}) records.push_back(ellipse_record(a, f, 1.0 / (f * 400), 4.2));
  const Identified found = model_type_registry().get("ellipse").identify(records, {});
  const Ellipse model = Ellipse::from(found.model.parameters);
  EXPECT_NEAR(model.at(30.0, 10.0).gain, 0.4 + 0.06 - 0.03, 1e-3);
  EXPECT_NEAR(model.at(60.0, 100.0).phase_rad, -0.1 - 0.04 - 0.06, 2e-3);
  EXPECT_NEAR(model.u_0, 75.0, 1e-3);
  const TimeRecord& record = records[4];
  // The first period runs on the assumed amplitude and frequency.
  EXPECT_LT(testing::errors_of(found, {&record, 1}, 0.2).rms_percent, 0.3);
}

/// Nodes over the amplitudes where they differ, in any unit; what is skipped counts for nothing.
TEST(Ellipse, NodesAreThoseOfTheRecordsAmplitudes) {
  for (const double unit : {1.0, 1e-3}) {
    for (const bool several : {false, true}) {
      std::vector<TimeRecord> records;
      for (const double a : several ? std::vector{10.0, 30.0, 60.0} : std::vector{30.0}) {
        records.push_back(ellipse_record(a, 10.0, 1.0 / 4000, 6.2));
        for (double& u : records.back().u) u *= unit;
        for (std::size_t i = 0; i < 500; ++i) records.back().y[i] += 40.0;
      }
      IdentifyOptions options;
      options.skip_s = 0.15;
      const Identified found = model_type_registry().get("ellipse").identify(records, options);
      const Ellipse model = Ellipse::from(found.model.parameters);
      EXPECT_EQ(model.u_a.size() > 1, several) << unit;
      EXPECT_NEAR(model.at(30.0 * unit, 10.0).gain * unit, 0.4 + 0.06 - 0.03, 1e-3) << several;
      EXPECT_NEAR(model.u_0, 75.0 * unit, 1e-3 * unit);
    }
  }
}

TEST(Ellipse, CoefficientsAreEquation5) {
  Parameters values;
  values.set("u_0", 75.0)
      .set("u_A", std::vector<double>{15.0})
      .set("frequency_hz", std::vector<double>{100.0});
  values.set("gain", std::vector<double>{0.45}).set("phase_rad", std::vector<double>{-0.12});
  values.set("y_0", std::vector<double>{30.0}).set("amplitude", 15.0).set("operating_hz", 100.0);
  const Ellipse model = Ellipse::from(make_model("ellipse", values).parameters);
  const double ts = 1e-4;
  const Ellipse::Coefficients p = model.coefficients(15.0, 100.0, ts);
  EllipseOperator op(model);
  op.reset(75.0);
  double before = 75.0;
  for (int k = 1; k < 20; ++k) {
    const double u = 75.0 + 15.0 * std::sin(2 * std::numbers::pi * 100.0 * k * ts);
    EXPECT_NEAR(op.step(u, ts), p.p1 * u + p.p2 * before + p.p3, 1e-10);
    before = u;
  }
  // Eq. 6 undoes eq. 2 on sinusoids, up to the difference quotient.
  const Ellipse::Coefficients q = model.inverse_coefficients(0.45 * 15.0, 100.0, 1e-6);
  double worst = 0.0;
  for (int k = 1; k < 20000; ++k) {
    const auto y = [&](double t) {
      return 30.0 + 0.45 * 15.0 * std::sin(2 * std::numbers::pi * 100.0 * t - 0.12);
    };
    const double u = q.p1 * y(k * 1e-6) + q.p2 * y((k - 1) * 1e-6) + q.p3;
    worst = std::max(worst, std::abs(u - 75.0 - 15.0 * std::sin(2 * std::numbers::pi * 100.0 * k * 1e-6)));
  }
  EXPECT_LT(worst, 2e-3);
  // The algebraic inverse of eq. 5 would be unstable: the header's remark.
  EXPECT_GT(std::abs(p.p2 / p.p1), 1.0);
}

/// Without a phase an ellipse is a line, whose inverse is exact from the first value on, whatever moves.
TEST(Ellipse, AnEllipseWithoutPhaseIsALine) {
  Ellipse line;
  line.u_0 = 75.0;
  line.u_a = {10.0};
  line.frequency_hz = {1.0};
  line.gain = {0.4};
  line.phase_rad = {0.0};
  line.y_0 = {30.0};
  EllipseOperator forward(line);
  EllipseInverse inverse(line);
  for (int i = 0; i < 50; ++i) {
    const double y = 30.0 + 5.0 * std::sin(0.1 * i * i + 1.0), u = 75.0 + (y - 30.0) / 0.4;
    EXPECT_NEAR(i == 0 ? inverse.reset(y) : inverse.step(y, 1e-3), u, 1e-12);
    EXPECT_NEAR(i == 0 ? forward.reset(u) : forward.step(u, 1e-3), y, 1e-12);
    EXPECT_NEAR(inverse.achieved(), y, 1e-12);
  }
}

TEST(Ellipse, InverseTracksASine) {
  std::vector<TimeRecord> records;
  for (const double a : {10.0, 20.0, 30.0}) records.push_back(ellipse_record(a, 50.0, 1e-5, 4.2));
  const Identified found = model_type_registry().get("ellipse").identify(records, {});
  const auto inverse = make_inverse(found.model);
  double worst = 0.0;
  for (int i = 0; i < 8000; ++i) {
    const double wanted = 30.0 + 9.0 * std::sin(2 * std::numbers::pi * 50.0 * i * 1e-5);
    if (i == 0)
      inverse->reset(wanted);
    else
      inverse->step(wanted, 1e-5);
    if (i > 6000) worst = std::max(worst, std::abs(inverse->achieved() - wanted));
  }
  EXPECT_LT(worst, 0.02 * 18.0);
}

}  // namespace
}  // namespace bodesmith::hysteresis
