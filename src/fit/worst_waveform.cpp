#include "fit/worst_waveform.hpp"

#include <algorithm>
#include <cmath>

#include "numeric/index.hpp"
#include "numeric/quadratic_program.hpp"

namespace bodesmith {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// One step as a program: variables are the step in units of the radius, then the level of the largest square, all in
/// units of the present one; rows are the operating frequencies, then the limits.
QuadraticProgram worst_step_program(const WaveformProblem& problem, const RootModel& model,
                                    const RootLimits& limits, const VectorXd& theta, double worst,
                                    double radius, const VectorXd& share) {
  const Index n = theta.size();
  const LinearLimits box = trust_region_limits(model, limits, theta, radius);
  QuadraticProgram p;
  p.q = MatrixXd::Zero(n + 1, n + 1);
  p.c = VectorXd::Zero(n + 1);
  p.c(n) = 1.0;
  p.a = MatrixXd::Zero(share.size() + box.b.size(), n + 1);
  p.b = VectorXd::Zero(share.size() + box.b.size());
  VectorXd e;
  MatrixXd slope;
  for (Index i = 0; i < share.size(); ++i) {
    problem.error(model, theta, std_index(i), e, &slope);
    p.a.block(i, 0, 1, n) = (2.0 * radius / worst) * (slope.transpose() * e).transpose();
    p.a(i, n) = -1.0;
    p.b(i) = -e.squaredNorm() / worst;
    p.q.topLeftCorner(n, n) += (2.0 * share(i) * radius * radius / worst) * slope.transpose() * slope;
  }
  p.a.bottomLeftCorner(box.b.size(), n) = box.a;
  p.b.tail(box.b.size()) = box.b;
  return p;
}

}  // namespace

SearchResult search_smallest_worst(const WaveformProblem& problem, const RootModel& model,
                                   const RootLimits& limits, VectorXd theta, int iterations) {
  const Index n = theta.size();
  const Index frequencies = eigen_index(problem.count());
  double worst = problem.worst_square(model, theta);
  // Multipliers of the frequencies: how much of the curvature each contributes.
  VectorXd share = VectorXd::Constant(frequencies, 1.0 / static_cast<double>(frequencies));
  double radius = 0.3;
  for (int iteration = 0; iteration < iterations && radius > 1e-9; ++iteration) {
    const QuadraticProgram program = worst_step_program(problem, model, limits, theta, worst, radius, share);
    VectorXd start = VectorXd::Zero(n + 1);
    start(n) = 1.1;
    const QuadraticProgramResult solution = solve_quadratic_program(program, start);
    VectorXd trial = theta + radius * solution.x.head(n);
    clamp(model, limits, trial);
    const double trial_worst = problem.worst_square(model, trial);
    const VectorXd multiplier = solution.multiplier.head(frequencies);
    if (multiplier.sum() > 0.0 && multiplier.allFinite())
      share = 0.5 * share + 0.5 * multiplier / multiplier.sum();
    if (trial_worst < worst) {
      const double won = worst - trial_worst;
      theta = trial;
      worst = trial_worst;
      radius = std::min(1.0, radius * 1.5);
      if (won < 1e-8 * worst) break;
    } else {
      radius *= 0.35;
    }
  }
  return {theta, std::sqrt(worst)};
}

}  // namespace bodesmith
