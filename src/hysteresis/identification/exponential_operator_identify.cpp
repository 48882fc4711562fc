#include <fmt/format.h>
#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "base/error.hpp"
#include "hysteresis/exponential_operator.hpp"
#include "hysteresis/identification/record_tools.hpp"
#include "hysteresis/model_type.hpp"
#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"
#include "numeric/optimisation/least_squares.hpp"

namespace bodesmith::hysteresis {
namespace {

/// Gains and L_off for given lags: linear.
struct GainFit {
  Eigen::VectorXd x;         ///< k…, L_off
  Eigen::VectorXd residual;  ///< model minus record
};

GainFit fit_gains(std::span<const TimeRecord> records, double skip_s, double v_off,
                  const Eigen::VectorXd& tau) {
  const Eigen::Index n = tau.size();
  const Eigen::VectorXd y = counted_outputs(records, skip_s);
  Eigen::MatrixXd a(y.size(), n + 1);
  a.col(n).setOnes();
  for (Eigen::Index i = 0; i < n; ++i) {
    ExponentialOperators one{.k = {1.0}, .tau = {tau(i)}, .v_off = v_off};
    ExponentialOperator op(one);
    Eigen::Index at = 0;
    drive(op, records, skip_s, [&](double value, const TimeRecord&, std::size_t) { a(at++, i) = value; });
  }
  GainFit out;
  Eigen::VectorXd scale = a.colwise().norm().transpose();
  for (Eigen::Index i = 0; i <= n; ++i) scale(i) = scale(i) > 0.0 ? 1.0 / scale(i) : 0.0;
  const Eigen::MatrixXd scaled = a * scale.asDiagonal();
  Eigen::MatrixXd gram = scaled.transpose() * scaled;
  gram.diagonal().array() += 1e-11;
  out.x = scale.asDiagonal() * solve_ldlt(gram, transpose_times(scaled, y));
  out.residual = a * out.x - y;
  return out;
}

/// What the paper's identification fits (its section 4): the gains (L − L_off)/(V − V_off) of every branch over
/// the distance from its turning point, both as measured.
struct BranchGains {
  std::vector<double> distance;
  std::vector<double> gain;
};

BranchGains branch_gains(std::span<const TimeRecord> records, double skip_s, double span) {
  BranchGains out;
  for (const TimeRecord& record : records) {
    const std::size_t first = first_counted(record, skip_s);
    for (const Branch& branch : branches(record.u)) {
      if (branch.first < first) continue;
      for (std::size_t i = branch.first + 1; i <= branch.last; ++i) {
        const double dv = record.u[i] - record.u[branch.first];
        if (std::abs(dv) < 0.01 * span) continue;  // the quotient is all noise there
        out.distance.push_back(std::abs(dv));
        out.gain.push_back((record.y[i] - record.y[branch.first]) / dv);
      }
    }
  }
  if (out.distance.empty()) throw InputError(records[0].file, 0, "no branch is long enough to show a gain");
  return out;
}

/// Sum of the squared errors of the gain curve with the gains and the logarithms of the lags in x; its gradient
/// where that is asked for.
double gain_curve_cost(const BranchGains& data, const Eigen::VectorXd& x, Eigen::VectorXd* gradient) {
  const Eigen::Index n = x.size() / 2;
  double sum = 0.0;
  if (gradient != nullptr) gradient->setZero(2 * n);
  for (std::size_t s = 0; s < data.gain.size(); ++s) {
    double error = -data.gain[s];
    for (Eigen::Index i = 0; i < n; ++i) error -= x(i) * std::expm1(-std::exp(x(n + i)) * data.distance[s]);
    sum += error * error;
    if (gradient == nullptr) continue;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double tau = std::exp(x(n + i));
      const double decay = std::exp(-tau * data.distance[s]);
      (*gradient)(i) += 2.0 * error * (1.0 - decay);
      (*gradient)(n + i) += 2.0 * error * x(i) * tau * data.distance[s] * decay;
    }
  }
  return sum;
}

/// The step t along a direction with the smallest cost, by strides from `first` on that grow while they gain and
/// shrink until they do; 0 when nothing is gained.
double line_search(const std::function<double(double)>& cost, double value, double first) {
  double best = 0.0;
  double best_value = value;
  double t = first;
  for (int probe = 0; probe<40; ++probe, t *= best> 0.0 ? 1.7 : 0.3) {
    const double here = cost(t);
    if (here < best_value) {
      best_value = here;
      best = t;
    } else if (best > 0.0) {
      break;
    }
  }
  return best;
}

/// Conjugate gradients (Polak and Ribière) on the cost of the gain curve, the unknowns in units of `scale`.
Eigen::VectorXd conjugate_gradients(const BranchGains& data, Eigen::VectorXd x,
                                    const Eigen::VectorXd& scale) {
  Eigen::VectorXd g, before;
  double value = gain_curve_cost(data, x, &g);
  g = g.cwiseProduct(scale);
  Eigen::VectorXd direction = -g;
  double length = 1e-3 / std::max(g.norm(), 1e-300);
  for (int iteration = 0; iteration < 400; ++iteration) {
    const double step = line_search(
        [&](double t) { return gain_curve_cost(data, x + t * scale.cwiseProduct(direction), nullptr); },
        value, length * 2.0);
    if (step == 0.0) {
      if ((direction + g).norm() < 1e-12 * g.norm()) break;
      direction = -g;
      length = 1e-3 / std::max(g.norm(), 1e-300);
      continue;
    }
    x += step * scale.cwiseProduct(direction);
    length = step;
    before = g;
    const double old = value;
    value = gain_curve_cost(data, x, &g);
    g = g.cwiseProduct(scale);
    if (old - value < 1e-9 * old) break;
    const double beta = std::max(0.0, g.dot(g - before) / std::max(before.squaredNorm(), 1e-300));
    direction = -g + beta * direction;
    if (direction.dot(g) >= 0.0) direction = -g;
  }
  return x;
}

/// The paper's identification: the measured gains of the branches, fitted by conjugate gradients over k and τ.
ExponentialOperators fit_gain_curve(std::span<const TimeRecord> records, double skip_s, int size,
                                    double span) {
  const BranchGains data = branch_gains(records, skip_s, span);
  double last = 0.0;
  for (std::size_t i = 0; i < data.gain.size(); ++i)
    if (data.distance[i] > 0.8 * span) last = std::max(last, data.gain[i]);
  const Eigen::Index n = size;
  Eigen::VectorXd start(2 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    start(i) = last / size;
    start(n + i) = std::log(100.0 / span * std::pow(0.005, static_cast<double>(i) / std::max(1, size - 1)));
  }
  // Gains and logarithms of lags differ by orders: unit scale for both.
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(2 * n);
  scale.head(n).setConstant(std::max(last, 1e-300));
  const Eigen::VectorXd x = conjugate_gradients(data, start, scale);
  ExponentialOperators out;
  out.k = to_vector(x.head(n));
  for (Eigen::Index i = 0; i < n; ++i) out.tau.push_back(std::exp(x(n + i)));
  return out;
}

/// Operators by the paper's method, their constant by what fits best.
ExponentialOperators fit_as_in_paper(std::span<const TimeRecord> records, double skip_s, int size,
                                     double span) {
  ExponentialOperators model = fit_gain_curve(records, skip_s, size, span);
  model.v_off = records[0].u[0];
  // L_off(0): the paper sets it "according to experimental observation"; here the constant that fits best.
  model.l_off = 0.0;
  Eigen::VectorXd residual;
  operator_residual(ExponentialOperator(model), records, skip_s, residual);
  model.l_off = -residual.mean();
  return model;
}

/// Lags by nonlinear least squares, gains linear inside it (variable projection).
ExponentialOperators fit_by_projection(std::span<const TimeRecord> records, double skip_s, int size,
                                       double span, bool& converged) {
  const Eigen::Index n = size;
  const double v_off = records[0].u[0];
  Eigen::VectorXd start(n);
  for (Eigen::Index i = 0; i < n; ++i)
    start(i) = std::log(60.0 / span * std::pow(0.008, static_cast<double>(i) / std::max(1, size - 1)));
  const auto lags = [](const Eigen::VectorXd& x) {
    return Eigen::VectorXd(x.unaryExpr([](double logarithm) { return std::exp(logarithm); }));
  };
  const LeastSquaresResult solved =
      fit_parameters([&](const Eigen::VectorXd& x,
                         Eigen::VectorXd& r) { r = fit_gains(records, skip_s, v_off, lags(x)).residual; },
                     start, Eigen::VectorXd::Constant(n, std::log(0.02 / span)),
                     Eigen::VectorXd::Constant(n, std::log(2000.0 / span)), Eigen::VectorXd::Ones(n), 30);
  const GainFit fit = fit_gains(records, skip_s, v_off, lags(solved.values));
  ExponentialOperators model;
  model.tau = to_vector(lags(solved.values));
  model.k = to_vector(fit.x.head(n));
  model.l_off = fit.x(n);
  model.v_off = v_off;
  converged = bodesmith::converged(solved.termination);
  return model;
}

/// At the solution, all parameters free.
std::vector<ParameterUncertainty> uncertainty_of(const ExponentialOperators& model,
                                                 std::span<const TimeRecord> records, double skip_s) {
  const Eigen::Index n = eigen_index(model.k.size());
  Eigen::VectorXd at(2 * n + 1), typical(2 * n + 1);
  at << as_eigen(model.k), as_eigen(model.tau), model.l_off;
  typical << Eigen::VectorXd::Constant(n, as_eigen(model.k).cwiseAbs().maxCoeff()), as_eigen(model.tau),
      output_range(records, skip_s).width();
  const double infinite = std::numeric_limits<double>::infinity();
  const LeastSquaresResult around = fit_parameters(
      [&](const Eigen::VectorXd& x, Eigen::VectorXd& r) {
        ExponentialOperators moved = model;
        as_eigen(moved.k) = x.head(n);
        as_eigen(moved.tau) = x.segment(n, n).cwiseMax(1e-300);
        moved.l_off = x(2 * n);
        operator_residual(ExponentialOperator(moved), records, skip_s, r);
      },
      at, Eigen::VectorXd::Constant(2 * n + 1, -infinite), Eigen::VectorXd::Constant(2 * n + 1, infinite),
      typical, 1);
  std::vector<ParameterUncertainty> out;
  add_uncertainty(out, "k", at, around.deviation, 0, n);
  add_uncertainty(out, "tau", at, around.deviation, n, n);
  out.push_back({"L_off", at(2 * n), around.deviation(2 * n)});
  return out;
}

}  // namespace

Identified identify_exponential_operators(std::span<const TimeRecord> records,
                                          const IdentifyOptions& options) {
  const double span = swept_range(records).width();
  const int size = options.size > 0 ? options.size : 4;
  ExponentialOperators model;
  Identified out;
  if (options.as_in_paper()) {
    model = fit_as_in_paper(records, options.skip_s, size, span);
    out.method =
        fmt::format("{} operators by conjugate gradients on the measured branch gains (section 4)", size);
  } else {
    model = fit_by_projection(records, options.skip_s, size, span, out.converged);
    out.method = fmt::format("{} operators: lags by nonlinear least squares, gains projected out", size);
  }
  out.uncertainty = uncertainty_of(model, records, options.skip_s);
  if (!model.rises())
    out.notes.push_back("the fitted curve falls somewhere: the model has no inverse (try another size)");
  out.model = make_model("exponential_operator", Parameters()
                                                     .set("k", model.k)
                                                     .set("tau", model.tau)
                                                     .set("V_off", model.v_off)
                                                     .set("L_off", model.l_off));
  return out;
}

}  // namespace bodesmith::hysteresis
