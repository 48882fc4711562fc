#include "fit/direct/constrained_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"
#include "numeric/optimisation/constrained_programs.hpp"

namespace bodesmith {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Np: a fit this close is exact, and further steps would polish rounding.
constexpr double kExact = 1e-9;

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
  Step solve(const Linearised& at, double radius) const {
    if (!least_squares_ && at.error.size() > kManyErrors) {
      if (const auto step = solve_by_exchange(at, radius)) return *step;
    }
    return solve_rows(at, radius);
  }

 private:
  static constexpr Index kNone = -1;
  /// With more errors than this most constraints are idle, which costs an exchange of rows next to nothing.
  static constexpr Index kManyErrors = 50;

  /// Chebyshev's by way of vertices of rows and bounds; nothing where rounding is in the way.
  std::optional<Step> solve_by_exchange(const Linearised& at, double radius) const {
    const double unit = std::max(at.merit, 1e-13);
    const Index n = at.theta.size();
    const bool masked = !target_.masks.empty();
    const Index size = masked ? n + 1 : n;
    LevelProgram p;
    p.error = at.error / unit;
    p.slope = MatrixXd::Zero(at.error.size(), size);
    p.slope.leftCols(n) = at.slope * (radius / unit);
    p.lower = VectorXd::Constant(size, -1.0);
    p.upper = VectorXd::Constant(size, 1.0);
    // Limits of one number are bounds, those of two stay rows.
    const LinearLimits limits = trust_region_limits(model_, limits_, at.theta, radius);
    std::vector<Index> rows;
    for (Index k = 0; k < limits.b.size(); ++k) {
      if ((limits.a.row(k).array() != 0.0).count() > 1) {
        rows.push_back(k);
        continue;
      }
      Index number = 0;
      const double bound = limits.b(k) / limits.a.row(k).cwiseAbs().maxCoeff(&number);
      if (limits.a(k, number) > 0.0) {
        p.upper(number) = std::min(p.upper(number), bound);
      } else {
        p.lower(number) = std::max(p.lower(number), -bound);
      }
    }
    const Index paired = eigen_index(rows.size());
    const Index masks = eigen_index(target_.masks.size());
    p.a = MatrixXd::Zero(paired + masks, size);
    p.b.resize(paired + masks);
    p.a.topLeftCorner(paired, n) = limits.a(rows, Eigen::all);
    p.b.head(paired) = limits.b(rows);
    if (masked) {
      p.lower(n) = 0.0;
      p.upper(n) = std::numeric_limits<double>::infinity();
      p.cost = VectorXd::Zero(size);
      p.cost(n) = kMaskCost;
      add_masks(at, radius, unit, n, p.a.bottomRows(masks), p.b.tail(masks));
    }
    const LevelResult found = solve_least_level(p);
    if (!found.solved) return std::nullopt;
    return step_to(at, radius * found.x.head(n), masked ? unit * found.x(n) : 0.0);
  }

  /// There, within the limits.
  Step step_to(const Linearised& at, const VectorXd& change, double violation) const {
    Step out{at.theta + change, 0.0};
    clamp(model_, limits_, out.theta);
    out.predicted = norm_of(at.error + at.slope * (out.theta - at.theta), least_squares_) +
                    kMaskCost * std::max(0.0, violation);
    return out;
  }

  Step solve_rows(const Linearised& at, double radius) const {
    const Index n = at.theta.size();
    const Index level = least_squares_ ? kNone : n;
    const Index violation = target_.masks.empty() ? kNone : n + (least_squares_ ? 0 : 1);
    const double unit = std::max(at.merit, 1e-13);
    const QuadraticProgram program = make_program(at, radius, unit, level, violation);
    VectorXd start = VectorXd::Zero(program.c.size());
    if (level != kNone) start(level) = 1.1;
    if (violation != kNone) start(violation) = 1.0;
    const QuadraticProgramResult solution = solve_quadratic_program(program, start);
    return step_to(at, radius * solution.x.head(n), violation != kNone ? unit * solution.x(violation) : 0.0);
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
    p.q = MatrixXd::Zero(size, size);
    p.c = VectorXd::Zero(size);
    p.a = MatrixXd::Zero(rows, size);
    p.b = VectorXd::Zero(rows);
    Index row = 0;
    if (least_squares_) {
      const double root = std::sqrt(static_cast<double>(errors));
      const double scale = radius / unit / root;
      p.q.topLeftCorner(n, n) = scale * scale * gram(at.slope);
      p.c.head(n) = scale * transpose_times(at.slope, at.error) / unit / root;
    } else {
      // -t <= error <= t.
      p.c(level) = 1.0;
      p.a.block(0, 0, errors, n) = at.slope * (radius / unit);
      p.a.block(errors, 0, errors, n) = -at.slope * (radius / unit);
      p.a.block(0, level, 2 * errors, 1).setConstant(-1.0);
      p.b.head(errors) = -at.error / unit;
      p.b.segment(errors, errors) = at.error / unit;
      row = 2 * errors;
    }
    p.a.block(row, 0, box.b.size(), n) = box.a;
    p.b.segment(row, box.b.size()) = box.b;
    row += box.b.size();
    if (violation == kNone) return p;
    add_masks(at, radius, unit, violation, p.a.middleRows(row, masks), p.b.segment(row, masks));
    p.a(rows - 1, violation) = -1.0;
    p.c(violation) = kMaskCost;
    return p;
  }

  /// A row a mask point: what lies over it is at most the violation.
  void add_masks(const Linearised& at, double radius, double unit, Index violation, Eigen::Ref<MatrixXd> a,
                 Eigen::Ref<VectorXd> b) const {
    Eigen::RowVectorXcd slope;
    Index row = 0;
    for (const CurveTarget::Mask& mask : target_.masks) {
      const double value = model_.log_response(at.theta, mask.frequency, &slope).real();
      a.block(row, 0, 1, at.theta.size()) = mask.side * slope.real() * (radius / unit);
      a(row, violation) = -1.0;
      b(row++) = mask.side * (mask.log_gain - value) / unit;
    }
  }

  const RootModel& model_;
  const CurveTarget& target_;
  const RootLimits& limits_;
  bool least_squares_;
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
  const StepProgram program(model, target, limits, least_squares);
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
    VectorXd step = least_norm_columns(slope, -error);
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
