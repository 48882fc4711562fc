// The search's error vector: its derivatives are those of differences, its size that of the waveform.
#include "fit/waveform/waveform_problem.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "fit/paper_disturbance.hpp"

namespace bodesmith {
namespace {

constexpr DrivenPath kPaths[] = {DrivenPath::whole, DrivenPath::descending};

/// A real root and a pair of each kind, near 60 rad/s.
struct Example {
  RootModel model{1, 1, 1, 1, RadPerSecond{60.0}};
  Eigen::VectorXd theta{model.size()};
  Example() {
    theta << 0.02, std::log(50.0), std::log(300.0), std::log(0.7), std::log(45.0), std::log(330.0),
        std::log(0.8);
  }
};

TEST(WaveformProblem, DerivativesAreThoseOfDifferences) {
  const Example at;
  for (const DrivenPath path : kPaths) {
    const WaveformProblem problem(both_driven(), {Hertz{3.0}, Hertz{40.0}}, path);
    Eigen::VectorXd e, above, below;
    Eigen::MatrixXd slope;
    problem.errors(at.model, at.theta, e, &slope);
    ASSERT_EQ(slope.rows(), e.size());
    ASSERT_EQ(slope.cols(), at.theta.size());
    for (Eigen::Index k = 0; k < at.theta.size(); ++k) {
      constexpr double kStep = 1e-5;
      Eigen::VectorXd moved = at.theta;
      moved(k) += kStep;
      problem.errors(at.model, moved, above, nullptr);
      moved(k) -= 2.0 * kStep;
      problem.errors(at.model, moved, below, nullptr);
      const Eigen::VectorXd wanted = (above - below) / (2.0 * kStep);
      EXPECT_LT((slope.col(k) - wanted).norm(), 1e-6 * (wanted.norm() + 1e-6)) << k;
    }
  }
}

TEST(WaveformProblem, SizesAreTheWaveformsErrors) {
  const Example at;
  const std::vector<Hertz> operating = {Hertz{3.0}, Hertz{40.0}};
  for (const DrivenPath path : kPaths) {
    const WaveformProblem problem(both_driven(), operating, path);
    WaveformErrorOptions options;
    options.path = path;
    const auto h = [&](RadPerSecond w) { return std::exp(at.model.log_response(at.theta, w)); };
    const WaveformError error = waveform_error(h, both_driven(), operating, options);
    double mean = 0.0, worst = 0.0;
    for (std::size_t i = 0; i < operating.size(); ++i) {
      Eigen::VectorXd e;
      problem.error(at.model, at.theta, i, e, nullptr);
      // 48 harmonics of 400.
      EXPECT_NEAR(100.0 * e.norm(), error.points[i].rms_percent, 0.05 * error.points[i].rms_percent) << i;
      mean += e.squaredNorm() / 2.0;
      worst = std::max(worst, e.squaredNorm());
    }
    Eigen::VectorXd all;
    problem.errors(at.model, at.theta, all, nullptr);
    EXPECT_NEAR(all.squaredNorm(), mean, 1e-12);
    EXPECT_NEAR(problem.worst_square(at.model, at.theta), worst, 1e-12);
  }
}

}  // namespace
}  // namespace bodesmith
