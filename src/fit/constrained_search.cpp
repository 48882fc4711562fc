#include "fit/constrained_search.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "numeric/index.hpp"
#include "numeric/quadratic_program.hpp"

namespace bodesmith {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Np: a fit this close is exact, and further steps would polish rounding.
constexpr double kExact = 1e-9;

/// Relative, of a step: rounds of rows agree to a thousand times as much.
constexpr double kStepGap = 1e-7;

/// Cost per neper of mask violation, against nepers of error.
constexpr double kMaskCost = 100.0;

double max_mask_violation(const RootModel& model, const CurveTarget& target, const VectorXd& theta) {
  double worst = 0.0;
  for (const CurveTarget::Mask& mask : target.masks) {
    worst = std::max(worst, mask.side * (model.log_response(theta, mask.frequency).real() - mask.log_gain));
  }
  return worst;
}

/// The norm that is made small.
double norm_of(const VectorXd& error, bool least_squares) {
  if (least_squares) return std::sqrt(error.squaredNorm() / static_cast<double>(error.size()));
  return error.cwiseAbs().maxCoeff();
}

/// The errors about one theta, in first order.
struct Linearised {
  VectorXd theta;
  VectorXd error;
  MatrixXd slope;
  double merit = 0.0;  ///< norm plus the cost of violated masks
};

/// One step as a program: variables are the step in units of the radius, then the level t of the largest error
/// (Chebyshev only), then the largest mask violation v (with masks only). Errors in units of the present merit, so that
/// it is well scaled whatever they are.
class StepProgram {
 public:
  StepProgram(const RootModel& model, const CurveTarget& target, const RootLimits& limits, bool least_squares)
      : model_(model), target_(target), limits_(limits), least_squares_(least_squares) {}

  struct Step {
    VectorXd theta;          ///< where it leads, within the limits
    double predicted = 0.0;  ///< merit there in first order
  };
  Step solve(const Linearised& at, double radius) {
    if (!least_squares_ && at.error.size() > kManyErrors) return solve_by_peaks(at, radius);
    return solve_rows(at, radius, at.error, at.slope).step;
  }

 private:
  static constexpr Index kNone = -1;
  /// With more errors than this most constraints are idle, and only those that may bind are written down.
  static constexpr Index kManyErrors = 100;
  static constexpr double kHolds = 1e-4;  ///< of all multipliers of the level, which sum up to 1

  struct Solved {
    Step step;
    double level = 0.0;  ///< of the rows written down, as the program found it, Np
    VectorXd
        hold;  ///< of each row written down: how much it holds the level up (the share of its multipliers)
  };

  /// The same program, its rows found one after the other: those where the error peaks, then where the step found
  /// would make it peak higher than the level of the rows so far, until it does so nowhere.
  Step solve_by_peaks(const Linearised& at, double radius) {
    std::vector<Index> rows = held_;  // what held the last step holds this one too, as a rule
    const auto add_peaks = [&](const Eigen::VectorXd& error, double above) {
      const std::size_t before = rows.size();
      const Index last = error.size() - 1;
      for (Index i = 0; i <= last; ++i) {
        const double here = std::abs(error(i));
        const bool peak =
            (i == 0 || here >= std::abs(error(i - 1))) && (i == last || here >= std::abs(error(i + 1)));
        if (peak && here > above && std::find(rows.begin(), rows.end(), i) == rows.end()) rows.push_back(i);
      }
      return rows.size() > before;
    };
    // Spread rows keep the first program bounded in every direction.
    const Index stride = std::max<Index>(1, at.error.size() / (4 * at.theta.size()));
    for (Index i = 0; i < at.error.size(); i += stride) {
      if (std::find(rows.begin(), rows.end(), i) == rows.end()) rows.push_back(i);
    }
    add_peaks(at.error, 0.5 * norm_of(at.error, false));
    constexpr int kRounds = 20;
    for (int round = 0;; ++round) {
      const Solved found = solve_rows(at, radius, at.error(rows), at.slope(rows, Eigen::all));
      const VectorXd there = at.error + at.slope * (found.step.theta - at.theta);
      if (round < kRounds && add_peaks(there, found.level * (1.0 + 1e-4))) continue;
      held_.clear();
      for (Index i = 0; i < found.hold.size(); ++i) {
        if (found.hold(i) > kHolds) held_.push_back(rows[std_index(i)]);
      }
      return found.step;
    }
  }

  Solved solve_rows(const Linearised& at, double radius, const VectorXd& error, const MatrixXd& slope) const {
    const Index n = at.theta.size();
    const Index level = least_squares_ ? kNone : n;
    const Index violation = target_.masks.empty() ? kNone : n + (least_squares_ ? 0 : 1);
    const double unit = std::max(at.merit, 1e-13);
    const QuadraticProgram program =
        make_program({at.theta, error, slope, at.merit}, radius, unit, level, violation);
    VectorXd start = VectorXd::Zero(program.c.size());
    if (level != kNone) start(level) = 1.1;
    if (violation != kNone) start(violation) = 1.0;
    const QuadraticProgramResult solution = solve_quadratic_program(program, start);
    Step step{at.theta + radius * solution.x.head(n), 0.0};
    clamp(model_, limits_, step.theta);
    step.predicted = norm_of(at.error + at.slope * (step.theta - at.theta), least_squares_);
    if (violation != kNone) step.predicted += kMaskCost * unit * std::max(0.0, solution.x(violation));
    if (level == kNone) return {std::move(step), 0.0, {}};
    return {std::move(step), unit * solution.x(level),
            solution.multiplier.head(error.size()) + solution.multiplier.segment(error.size(), error.size())};
  }

  QuadraticProgram make_program(const Linearised& at, double radius, double unit, Index level,
                                Index violation) const {
    const Index n = at.theta.size();
    const Index errors = at.error.size();
    const Index size = n + (level != kNone ? 1 : 0) + (violation != kNone ? 1 : 0);
    const LinearLimits box = trust_region_limits(model_, limits_, at.theta, radius);
    const Index masks = eigen_index(target_.masks.size());
    const Index rows =
        (level != kNone ? 2 * errors : 0) + box.b.size() + (violation != kNone ? masks + 1 : 0);
    QuadraticProgram p;
    if (!least_squares_) p.gap = kStepGap;
    p.q = MatrixXd::Zero(size, size);
    p.c = VectorXd::Zero(size);
    p.a = MatrixXd::Zero(rows, size);
    p.b = VectorXd::Zero(rows);
    Index row = 0;
    if (least_squares_) {
      const double root = std::sqrt(static_cast<double>(errors));
      const double scale = radius / unit / root;
      p.q.topLeftCorner(n, n) = scale * scale * at.slope.transpose() * at.slope;
      p.c.head(n) = scale * at.slope.transpose() * at.error / unit / root;
    } else {
      // -t <= error <= t.
      p.c(level) = 1.0;
      p.a.block(0, 0, errors, n) = at.slope * (radius / unit);
      p.a.block(errors, 0, errors, n) = -at.slope * (radius / unit);
      p.a.block(0, level, 2 * errors, 1).setConstant(-1.0);
      p.b.head(errors) = -at.error / unit;
      p.b.segment(errors, errors) = at.error / unit;
      p.pairs = errors;
      p.level = level;
      row = 2 * errors;
    }
    p.a.block(row, 0, box.b.size(), n) = box.a;
    p.b.segment(row, box.b.size()) = box.b;
    row += box.b.size();
    if (violation != kNone) add_masks(p, at, radius, unit, violation, row);
    return p;
  }

  void add_masks(QuadraticProgram& p, const Linearised& at, double radius, double unit, Index violation,
                 Index row) const {
    Eigen::RowVectorXcd slope;
    for (const CurveTarget::Mask& mask : target_.masks) {
      const double value = model_.log_response(at.theta, mask.frequency, &slope).real();
      p.a.block(row, 0, 1, at.theta.size()) = mask.side * slope.real() * (radius / unit);
      p.a(row, violation) = -1.0;
      p.b(row++) = mask.side * (mask.log_gain - value) / unit;
    }
    p.a(row, violation) = -1.0;
    p.c(violation) = kMaskCost;
  }

  const RootModel& model_;
  const CurveTarget& target_;
  const RootLimits& limits_;
  bool least_squares_;
  std::vector<Index> held_;
};

}  // namespace

SearchResult search_constrained(const RootModel& model, const CurveTarget& target, const RootLimits& limits,
                                VectorXd theta, bool least_squares, int iterations) {
  double radius = kFirstRadius;
  return search_constrained(model, target, limits, std::move(theta), least_squares, iterations, radius);
}

SearchResult search_constrained(const RootModel& model, const CurveTarget& target, const RootLimits& limits,
                                VectorXd theta, bool least_squares, int iterations, double& radius) {
  clamp(model, limits, theta);
  StepProgram program(model, target, limits, least_squares);
  const auto merit_of = [&](const VectorXd& at, const VectorXd& error) {
    return norm_of(error, least_squares) + kMaskCost * max_mask_violation(model, target, at);
  };
  Linearised now{theta, {}, {}, 0.0};
  curve_errors(model, target, now.theta, now.error, &now.slope);
  now.merit = merit_of(now.theta, now.error);
  for (int iteration = 0; iteration < iterations && radius > 1e-10 && now.merit > kExact; ++iteration) {
    const StepProgram::Step step = program.solve(now, radius);
    VectorXd error;
    curve_errors(model, target, step.theta, error, nullptr);
    const double merit = merit_of(step.theta, error);
    const double expected = now.merit - step.predicted;
    const double won = now.merit - merit;
    if (won > 0.0) {
      const double length = (step.theta - now.theta).cwiseAbs().maxCoeff();
      now.theta = step.theta;
      now.merit = merit;
      curve_errors(model, target, now.theta, now.error, &now.slope);
      if (won > 0.75 * expected && length > 0.9 * radius) radius = std::min(2.0, 2.0 * radius);
      if (won < 0.25 * expected) radius *= 0.5;
      if (won < 1e-5 * merit && expected < 1e-4 * merit) break;
    } else {
      radius *= 0.25;
      if (expected < 1e-6 * now.merit) break;
    }
  }
  return {now.theta, now.merit};
}

SearchResult search_interpolation(const RootModel& model, const CurveTarget& target, const RootLimits& limits,
                                  VectorXd theta, int iterations) {
  VectorXd error;
  MatrixXd slope;
  VectorXd best = theta;
  curve_errors(model, target, theta, error, &slope);
  double value = error.cwiseAbs().maxCoeff();
  for (int i = 0; i < iterations && value > 1e-14; ++i) {
    VectorXd step = slope.completeOrthogonalDecomposition().solve(-error);
    const double largest = step.cwiseAbs().maxCoeff();
    if (largest > 0.5) step *= 0.5 / largest;
    theta += step;
    clamp(model, limits, theta);
    curve_errors(model, target, theta, error, &slope);
    const double now = error.cwiseAbs().maxCoeff();
    if (now < value) {
      value = now;
      best = theta;
    }
  }
  return {best, value};
}

}  // namespace bodesmith
