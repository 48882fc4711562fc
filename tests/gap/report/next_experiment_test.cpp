// The drive that is proposed after a tie: within what was asked, and what each rival predicts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/files.hpp"
#include "chain/model_file.hpp"
#include "gap/diagnosis.hpp"
#include "numeric/random.hpp"
#include "temporary_folder.hpp"

namespace bodesmith::gap {
namespace {

/// One slow sine through a lag that turns it by a tenth of a radian: a delay does the same.
TimeRecord lagging_sine() {
  TimeRecord out;
  out.file = "sine.csv";
  out.step_s = 1e-3;
  Random random(11);
  constexpr double kHz = 10.0;
  constexpr double kCorner = 100.0;
  const double a = 2.0 * std::numbers::pi * kCorner * out.step_s;
  const double e = std::exp(-a);
  const double g = (1.0 - e) / a;
  double y = 0.0;
  double before = 0.0;
  for (int i = 0; i < 400; ++i) {
    const double u = std::sin(2.0 * std::numbers::pi * kHz * out.step_s * i);
    if (i > 0) y = e * y + (g - e) * before + (1.0 - g) * u;
    before = u;
    out.u.push_back(u);
    out.y.push_back(y + 0.03 * random.normal());
  }
  return out;
}

Diagnosis diagnosed_sine(const DriveRequest& drive) {
  const TemporaryFolder folder;
  const TimeRecord record = lagging_sine();
  std::string text = "time_s,u,y\n";
  for (std::size_t i = 0; i < record.u.size(); ++i)
    text += std::to_string(1e-3 * static_cast<double>(i)) + "," + std::to_string(record.u[i]) + "," +
            std::to_string(record.y[i]) + "\n";
  write_file(folder / "sine.csv", text);
  write_file(folder / "model.toml",
             "schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"gain\"\ngain = 1.0\nfree = [\"gain\"]\n");
  Provenance from;
  const auto base = chain::read_model(folder / "model.toml", from);
  const auto study = Study::read({folder / "sine.csv"}, {}, base, from);
  SearchOptions options;
  options.threads = 1;
  options.drive = drive;
  return diagnose(base, study, options);
}

TEST(NextExperiment, IsWithinWhatWasAskedAndKeepsTheRivalsApart) {
  DriveRequest request;
  request.lower = -0.5;
  request.upper = 0.8;
  request.max_rate = 200.0;
  request.duration_s = 0.25;
  request.step_s = 5e-4;
  const Diagnosis d = diagnosed_sine(request);
  ASSERT_EQ(d.steps.size(), 1u);
  ASSERT_FALSE(d.steps[0].tied_with.empty());
  ASSERT_TRUE(d.next_experiment.has_value());
  const NextExperiment& e = *d.next_experiment;
  EXPECT_DOUBLE_EQ(e.step_s, 5e-4);
  EXPECT_EQ(e.u.size(), 500u);
  EXPECT_GE(*std::min_element(e.u.begin(), e.u.end()), -0.5);
  EXPECT_LE(*std::max_element(e.u.begin(), e.u.end()), 0.8);
  for (std::size_t i = 1; i < e.u.size(); ++i) EXPECT_LE(std::abs(e.u[i] - e.u[i - 1]), 200.0 * 5e-4 + 1e-12);
  ASSERT_EQ(e.predicted.size(), e.rivals.size());
  ASSERT_GE(e.rivals.size(), 2u);
  double apart = 0.0;
  for (std::size_t i = 0; i < e.u.size(); ++i)
    apart = std::max(apart, std::abs(e.predicted[0][i] - e.predicted[1][i]));
  EXPECT_GT(apart, 0.02);
  EXPECT_GT(e.difference_over_noise, 0.0);
  EXPECT_NE(to_csv(e).find("time_s,u,y_" + e.rivals[0]), std::string::npos);
}

/// rms of the difference of the two rivals furthest apart.
double widest(const NextExperiment& e) {
  double out = 0.0;
  for (const auto& a : e.predicted) {
    for (const auto& b : e.predicted) {
      double square = 0.0;
      for (std::size_t i = 0; i < a.size(); ++i) square += (a[i] - b[i]) * (a[i] - b[i]);
      out = std::max(out, std::sqrt(square / static_cast<double>(a.size())));
    }
  }
  return out;
}

TEST(NextExperiment, AFasterDriveTellsMore) {
  const Diagnosis as_recorded = diagnosed_sine({});
  DriveRequest faster;
  faster.max_rate = 1000.0;
  const Diagnosis fast = diagnosed_sine(faster);
  ASSERT_TRUE(as_recorded.next_experiment && fast.next_experiment);
  // Of the nearest two nothing is said: a hold and a delay of half its period differ by less than any noise.
  EXPECT_GT(widest(*fast.next_experiment), 1.5 * widest(*as_recorded.next_experiment));
  // Without a word it keeps to the record's range and length.
  const auto& u = as_recorded.next_experiment->u;
  EXPECT_LE(*std::max_element(u.begin(), u.end()), 1.0);
  EXPECT_EQ(u.size(), 400u);
}

}  // namespace
}  // namespace bodesmith::gap
