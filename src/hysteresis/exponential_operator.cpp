#include "hysteresis/exponential_operator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "hysteresis/record_tools.hpp"
#include "hysteresis/registry.hpp"
#include "numeric/least_squares.hpp"

namespace bodesmith::hysteresis {

ExponentialOperators ExponentialOperators::from(const Parameters& values) {
  ExponentialOperators out;
  out.k = values.array("k");
  out.tau = values.array("tau");
  out.v_off = values.scalar("V_off");
  out.l_off = values.scalar("L_off");
  if (out.k.empty() || out.k.size() != out.tau.size())
    throw DesignError(
        fmt::format("k has {} and tau has {} numbers, expected as many", out.k.size(), out.tau.size()));
  return out;
}

double ExponentialOperators::gain_curve(double x) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < k.size(); ++i) sum -= k[i] * std::expm1(-tau[i] * x);
  return sum * x;
}

double ExponentialOperators::slope(double x) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < k.size(); ++i) {
    const double decay = std::exp(-tau[i] * x);
    sum += k[i] * (1.0 - decay + tau[i] * x * decay);
  }
  return sum;
}

double ExponentialOperators::solve(double y) const {
  if (!(y > 0.0)) return 0.0;
  double total = 0.0;
  for (const double part : k) total += part;
  double low = 0.0;
  double high = y / total;
  while (gain_curve(high) < y && high < 1e300) high *= 2.0;
  double x = high;
  double best = high;
  double best_miss = std::abs(gain_curve(high) - y);
  for (int i = 0; i < 200; ++i) {
    const double miss = gain_curve(x) - y;
    if (std::abs(miss) < best_miss) {
      best = x;
      best_miss = std::abs(miss);
    }
    if (miss == 0.0) break;
    (miss > 0.0 ? high : low) = x;
    const double newton = x - miss / slope(x);
    const double next = newton > low && newton < high ? newton : 0.5 * (low + high);
    if (next == x || next <= low || next >= high) break;
    x = next;
  }
  return best;
}

bool ExponentialOperators::rises() const {
  double total = 0.0;
  double slowest = std::numeric_limits<double>::infinity();
  double fastest = 0.0;
  for (std::size_t i = 0; i < k.size(); ++i) {
    total += k[i];
    slowest = std::min(slowest, tau[i]);
    fastest = std::max(fastest, tau[i]);
  }
  if (!(total > 0.0)) return false;
  for (double x = 1e-3 / fastest; x < 60.0 / slowest; x *= 1.03)
    if (!(slope(x) > 0.0)) return false;
  return true;
}

ExponentialOperators ExponentialOperators::dominant_only() const {
  const auto d = static_cast<std::size_t>(std::min_element(tau.begin(), tau.end()) - tau.begin());
  double total = 0.0;
  for (const double part : k) total += part;
  ExponentialOperators out = *this;
  out.k = {total - k[d], k[d]};
  out.tau = {1e9, tau[d]};
  return out;
}

ExponentialOperator::ExponentialOperator(ExponentialOperators model) : loops_(std::move(model), 4096) {
  reset(loops_.rule().v_off);
}

double ExponentialOperator::reset(double u) {
  const ExponentialOperators& rule = loops_.rule();
  loops_.start(rule.v_off, rule.l_off, u >= rule.v_off ? 1 : -1);
  return loops_.step(u);
}

ExponentialInverse::ExponentialInverse(ExponentialOperators model) : forward_(std::move(model)) {
  if (!forward_.loops_.rule().rises())
    throw DesignError(
        "the operators' curve g(x) = sum of k (1 - exp(-tau x)) x falls somewhere: there is no inverse");
}

double ExponentialInverse::reset(double y) {
  const ExponentialOperators& rule = forward_.loops_.rule();
  forward_.loops_.start(rule.v_off, rule.l_off, y >= rule.l_off ? 1 : -1);
  return forward_.loops_.invert(y);
}

TimeRecord exchanged(const TimeRecord& record) {
  TimeRecord out = record;
  std::swap(out.u, out.y);
  return out;
}

namespace {

const std::vector<ParameterInfo>& infos() {
  static const std::vector<ParameterInfo> list = {
      array("k", "y/u", "gains of the operators"),
      array("tau", "1/u", "lags of the operators", 1e-300),
      optional(scalar("V_off", "u", "input of the first turning point"), {0.0}),
      optional(scalar("L_off", "y", "output of the first turning point"), {0.0}),
  };
  return list;
}

void check(const Parameters& values) {
  (void)ExponentialOperators::from(values);
}
std::unique_ptr<Operator> make(const Parameters& values) {
  return std::make_unique<ExponentialOperator>(ExponentialOperators::from(values));
}
std::unique_ptr<Inverse> make_inverse_of(const Parameters& values) {
  return std::make_unique<ExponentialInverse>(ExponentialOperators::from(values));
}

/// Gains and L_off for given lags: linear. Returns the residual (model minus record).
struct GainFit {
  Eigen::VectorXd x;  ///< k…, L_off
  Eigen::VectorXd residual;
};
GainFit fit_gains(std::span<const TimeRecord> records, double skip_s, double v_off,
                  const std::vector<double>& tau) {
  const auto n = static_cast<Eigen::Index>(tau.size());
  const auto rows = static_cast<Eigen::Index>(counted_samples(records, skip_s));
  Eigen::MatrixXd a(rows, n + 1);
  Eigen::VectorXd y(rows);
  a.col(n).setOnes();
  for (Eigen::Index i = 0; i < n; ++i) {
    ExponentialOperators one;
    one.k = {1.0};
    one.tau = {tau[static_cast<std::size_t>(i)]};
    one.v_off = v_off;
    ExponentialOperator op(one);
    Eigen::Index at = 0;
    for (const TimeRecord& record : records) {
      const std::size_t first = first_counted(record, skip_s);
      double value = op.reset(record.u[0]);
      for (std::size_t t = 0; t < record.size(); ++t) {
        if (t > 0) value = op.step(record.u[t], record.step_s);
        if (t < first) continue;
        a(at, i) = value;
        y(at++) = record.y[t];
      }
    }
  }
  GainFit out;
  Eigen::VectorXd scale = a.colwise().norm().transpose();
  for (Eigen::Index i = 0; i <= n; ++i) scale(i) = scale(i) > 0.0 ? 1.0 / scale(i) : 0.0;
  const Eigen::MatrixXd scaled = a * scale.asDiagonal();
  Eigen::MatrixXd gram = scaled.transpose() * scaled;
  gram.diagonal().array() += 1e-11;
  out.x = scale.asDiagonal() * gram.ldlt().solve(scaled.transpose() * y);
  out.residual = a * out.x - y;
  return out;
}

/// The paper's identification (its section 4): the gain (L − L_off)/(V − V_off) of every branch, measured
/// from the measured turning points, fitted by conjugate gradients (Polak and Ribière) over k and τ.
ExponentialOperators fit_gain_curve(std::span<const TimeRecord> records, double skip_s, int size,
                                    double span) {
  std::vector<double> distance, gain;
  for (const TimeRecord& record : records) {
    const std::size_t first = first_counted(record, skip_s);
    for (const Branch& branch : branches(record.u)) {
      if (branch.first < first) continue;
      for (std::size_t i = branch.first + 1; i <= branch.last; ++i) {
        const double dv = record.u[i] - record.u[branch.first];
        if (std::abs(dv) < 0.01 * span) continue;  // the quotient is all noise there
        distance.push_back(std::abs(dv));
        gain.push_back((record.y[i] - record.y[branch.first]) / dv);
      }
    }
  }
  if (distance.empty()) throw InputError(records[0].file, 0, "no branch is long enough to show a gain");
  const auto n = static_cast<Eigen::Index>(size);
  Eigen::VectorXd x(2 * n);
  double last = 0.0;
  for (std::size_t i = 0; i < gain.size(); ++i)
    if (distance[i] > 0.8 * span) last = std::max(last, gain[i]);
  for (Eigen::Index i = 0; i < n; ++i) {
    x(i) = last / size;
    x(n + i) = std::log(100.0 / span * std::pow(0.005, static_cast<double>(i) / std::max(1, size - 1)));
  }
  const auto cost = [&](const Eigen::VectorXd& at, Eigen::VectorXd* gradient) {
    double sum = 0.0;
    if (gradient != nullptr) gradient->setZero(2 * n);
    for (std::size_t s = 0; s < gain.size(); ++s) {
      double miss = -gain[s];
      for (Eigen::Index i = 0; i < n; ++i) miss -= at(i) * std::expm1(-std::exp(at(n + i)) * distance[s]);
      sum += miss * miss;
      if (gradient == nullptr) continue;
      for (Eigen::Index i = 0; i < n; ++i) {
        const double tau = std::exp(at(n + i));
        const double decay = std::exp(-tau * distance[s]);
        (*gradient)(i) += 2.0 * miss * (1.0 - decay);
        (*gradient)(n + i) += 2.0 * miss * at(i) * tau * distance[s] * decay;
      }
    }
    return sum;
  };
  Eigen::VectorXd g, before, direction;
  // Gains and logarithms of lags differ by orders: unit scale for both.
  const double unit = std::max(last, 1e-300);
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(2 * n);
  scale.head(n).setConstant(unit);
  double value = cost(x, &g);
  g = g.cwiseProduct(scale);
  direction = -g;
  double length = 1e-3 / std::max(g.norm(), 1e-300);
  for (int iteration = 0; iteration < 400; ++iteration) {
    bool moved = false;
    double best_length = 0.0;
    double best_value = value;
    double t = length * 2.0;
    for (int probe = 0; probe < 40; ++probe, t *= moved ? 1.7 : 0.3) {
      const double here = cost(x + t * scale.cwiseProduct(direction), nullptr);
      if (here < best_value) {
        best_value = here;
        best_length = t;
        moved = true;
      } else if (moved) {
        break;
      }
    }
    if (!moved) {
      if ((direction + g).norm() < 1e-12 * g.norm()) break;
      direction = -g;
      length = 1e-3 / std::max(g.norm(), 1e-300);
      continue;
    }
    x += best_length * scale.cwiseProduct(direction);
    length = best_length;
    before = g;
    const double old = value;
    value = cost(x, &g);
    g = g.cwiseProduct(scale);
    if (old - value < 1e-9 * old) break;
    const double beta = std::max(0.0, g.dot(g - before) / std::max(before.squaredNorm(), 1e-300));
    direction = -g + beta * direction;
    if (direction.dot(g) >= 0.0) direction = -g;
  }
  ExponentialOperators out;
  for (Eigen::Index i = 0; i < n; ++i) {
    out.k.push_back(x(i));
    out.tau.push_back(std::exp(x(n + i)));
  }
  return out;
}

Identified identify(std::span<const TimeRecord> records, const IdentifyOptions& options) {
  const Stopwatch watch;
  const Range u = input_range(records, 0.0);
  if (!(u.width() > 0.0))
    throw InputError(records[0].file, 0, "the input never moves, expected a record that sweeps it");
  const int size = options.size > 0 ? options.size : 4;
  const double v_off = records[0].u[0];
  const double span = u.width();
  ExponentialOperators model;
  Identified out;
  if (options.method == "paper") {
    model = fit_gain_curve(records, options.skip_s, size, span);
    model.v_off = v_off;
    // L_off(0): the paper sets it "according to experimental observation"; here the constant that fits best.
    model.l_off = 0.0;
    Eigen::VectorXd residual;
    operator_residual(ExponentialOperator(model), records, options.skip_s, residual);
    model.l_off = -residual.mean();
    out.method =
        fmt::format("{} operators by conjugate gradients on the measured branch gains (section 4)", size);
  } else {
    // Lags by nonlinear least squares, gains linear inside it (variable projection).
    const auto n = static_cast<Eigen::Index>(size);
    Eigen::VectorXd start(n);
    for (Eigen::Index i = 0; i < n; ++i)
      start(i) = std::log(60.0 / span * std::pow(0.008, static_cast<double>(i) / std::max(1, size - 1)));
    const auto lags = [&](const Eigen::VectorXd& x) {
      std::vector<double> tau;
      for (Eigen::Index i = 0; i < n; ++i) tau.push_back(std::exp(x(i)));
      return tau;
    };
    const LeastSquaresResult solved = least_squares(
        [&](const Eigen::VectorXd& x, Eigen::VectorXd& r) {
          r = fit_gains(records, options.skip_s, v_off, lags(x)).residual;
        },
        start, Eigen::VectorXd::Constant(n, std::log(0.02 / span)),
        Eigen::VectorXd::Constant(n, std::log(2000.0 / span)), Eigen::VectorXd::Ones(n), 30);
    const GainFit fit = fit_gains(records, options.skip_s, v_off, lags(solved.x));
    model.tau = lags(solved.x);
    for (Eigen::Index i = 0; i < n; ++i) model.k.push_back(fit.x(i));
    model.l_off = fit.x(n);
    model.v_off = v_off;
    out.converged = solved.converged;
    out.method = fmt::format("{} operators: lags by nonlinear least squares, gains projected out", size);
  }
  // Deviations at the solution, all parameters free.
  const auto n = static_cast<Eigen::Index>(model.k.size());
  Eigen::VectorXd at(2 * n + 1), typical(2 * n + 1);
  double gain = 0.0;
  for (const double one : model.k) gain = std::max(gain, std::abs(one));
  for (Eigen::Index i = 0; i < n; ++i) {
    at(i) = model.k[static_cast<std::size_t>(i)];
    at(n + i) = model.tau[static_cast<std::size_t>(i)];
    typical(i) = gain;
    typical(n + i) = at(n + i);
  }
  at(2 * n) = model.l_off;
  typical(2 * n) = output_range(records, options.skip_s).width();
  const double infinite = std::numeric_limits<double>::infinity();
  const LeastSquaresResult around = least_squares(
      [&](const Eigen::VectorXd& x, Eigen::VectorXd& r) {
        ExponentialOperators moved = model;
        for (Eigen::Index i = 0; i < n; ++i) {
          moved.k[static_cast<std::size_t>(i)] = x(i);
          moved.tau[static_cast<std::size_t>(i)] = std::max(x(n + i), 1e-300);
        }
        moved.l_off = x(2 * n);
        operator_residual(ExponentialOperator(moved), records, options.skip_s, r);
      },
      at, Eigen::VectorXd::Constant(2 * n + 1, -infinite), Eigen::VectorXd::Constant(2 * n + 1, infinite),
      typical, 1);
  for (Eigen::Index i = 0; i < n; ++i)
    out.uncertainty.push_back({fmt::format("k[{}]", i), at(i), around.deviation(i)});
  for (Eigen::Index i = 0; i < n; ++i)
    out.uncertainty.push_back({fmt::format("tau[{}]", i), at(n + i), around.deviation(n + i)});
  out.uncertainty.push_back({"L_off", at(2 * n), around.deviation(2 * n)});
  if (!model.rises())
    out.notes.push_back("the fitted curve falls somewhere: the model has no inverse (try another size)");
  Parameters values;
  values.set("k", model.k).set("tau", model.tau).set("V_off", model.v_off).set("L_off", model.l_off);
  out.stage.model = checked_model("exponential_operator", values);
  out.compute_s = watch.seconds();
  return out;
}

}  // namespace

ModelType exponential_operator_type() {
  return {"exponential_operator",
          "sum of exponential branches from the last turning point, on a stack of extremes",
          "002, eq. 2-5, conditions 1-4",
          infos(),
          check,
          make,
          make_inverse_of,
          identify};
}

}  // namespace bodesmith::hysteresis
