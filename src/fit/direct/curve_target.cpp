#include "fit/direct/curve_target.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "lti/frequency_grid.hpp"
#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"
#include "numeric/linear_algebra/matrix_products.hpp"

namespace bodesmith {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Magnitudes at so many frequencies are worked out root by root.
constexpr Index kDense = 100;

/// ln of the mask's gain at ln w; nothing outside its range.
std::optional<double> mask_log_gain(const BodePoints& mask, double log_w) {
  const auto& p = mask.points;
  for (std::size_t i = 0; i + 1 < p.size(); ++i) {
    const double a = std::log(p[i].frequency.rad_s().value);
    const double b = std::log(p[i + 1].frequency.rad_s().value);
    if (log_w < a - 1e-12 || log_w > b + 1e-12) continue;
    const double t = (log_w - a) / (b - a);
    return (1 - t) * std::log(p[i].gain) + t * std::log(p[i + 1].gain);
  }
  return std::nullopt;
}

/// Point i of `from`, without its masks.
void append_point(CurveTarget& to, const CurveTarget& from, std::size_t i) {
  to.frequency.push_back(from.frequency[i]);
  to.log_gain.push_back(from.log_gain[i]);
  to.weight.push_back(from.weight[i]);
  if (from.has_phase()) to.phase_rad.push_back(from.phase_rad[i]);
}

}  // namespace

void curve_errors(const RootModel& model, const CurveTarget& target, const VectorXd& theta, VectorXd& error,
                  MatrixXd* slope) {
  const Index n = eigen_index(target.frequency.size());
  const bool phase = target.has_phase();
  error.resize(phase ? 2 * n : n);
  if (slope != nullptr) slope->resize(error.size(), theta.size());
  if (!phase && n >= kDense) {
    RootResponse(model, theta).levels(target.frequency, error, slope);
    error = as_eigen(target.weight).cwiseProduct(error - as_eigen(target.log_gain));
    if (slope != nullptr) slope->array().colwise() *= as_eigen(target.weight).array();
    return;
  }
  Eigen::RowVectorXcd row(theta.size());
  const RootResponse response(model, theta);
  for (Index i = 0; i < n; ++i) {
    const std::size_t at = std_index(i);
    const auto value = response.at(target.frequency[at], slope != nullptr ? &row : nullptr, phase);
    const double weight = target.weight[at];
    error(i) = weight * (value.real() - target.log_gain[at]);
    if (slope != nullptr) slope->row(i) = weight * row.real();
    if (phase) {
      error(n + i) = weight * (value.imag() - target.phase_rad[at]);
      if (slope != nullptr) slope->row(n + i) = weight * row.imag();
    }
  }
}

SearchResult search_least_squares(const RootModel& model, const ErrorFunction& errors_at,
                                  const RootLimits& limits, VectorXd theta, int iterations) {
  clamp(model, limits, theta);
  VectorXd error;
  MatrixXd slope;
  errors_at(theta, error, &slope);
  double value = error.squaredNorm();
  double damping = 1e-2;
  int small = 0;
  for (int i = 0; i < iterations && damping < 1e10; ++i) {
    const TallMatrix rows(slope);
    const MatrixXd normal = rows.gram(VectorXd::Ones(slope.rows()));
    const VectorXd downhill = -rows.transpose_times(error);
    MatrixXd damped = normal;
    damped.diagonal().array() +=
        damping * (1e-6 * normal.diagonal().maxCoeff() + normal.diagonal().array()) + 1e-14;
    VectorXd step = solve_ldlt(damped, downhill);
    const double largest = step.tail(step.size() - 1).cwiseAbs().maxCoeff();
    if (largest > 1.5) step *= 1.5 / largest;
    VectorXd trial = theta + step;
    clamp(model, limits, trial);
    VectorXd trial_error;
    errors_at(trial, trial_error, nullptr);
    const double trial_value = trial_error.squaredNorm();
    if (trial_value < value) {
      small = value - trial_value < 1e-6 * value ? small + 1 : 0;
      theta = trial;
      value = trial_value;
      errors_at(theta, error, &slope);
      damping = std::max(1e-9, damping / 5.0);
      if (small > 3) break;
    } else {
      damping *= 4.0;
    }
  }
  return {theta, std::sqrt(value / static_cast<double>(error.size()))};
}

SearchResult search_least_squares(const RootModel& model, const CurveTarget& target, const RootLimits& limits,
                                  VectorXd theta, int iterations) {
  const ErrorFunction errors_at = [&](const VectorXd& at, VectorXd& error, MatrixXd* slope) {
    curve_errors(model, target, at, error, slope);
  };
  return search_least_squares(model, errors_at, limits, std::move(theta), iterations);
}

CurveTarget make_curve_target(const BodePoints& points, bool use_phase) {
  CurveTarget target;
  double turns = 0.0;
  double last = 0.0;
  for (const BodePoint& point : points.points) {
    if (point.weight == 0.0) continue;
    target.frequency.push_back(point.frequency.rad_s());
    target.log_gain.push_back(std::log(point.gain));
    target.weight.push_back(point.weight);
    if (!use_phase) continue;
    if (!point.phase_deg)
      throw InputError(points.file, point.line, "has no phase_deg, expected one to fit phase");
    const double here = to_radians(*point.phase_deg);
    if (target.has_phase())
      turns -= 2.0 * std::numbers::pi * std::round((here + turns - last) / (2.0 * std::numbers::pi));
    last = here + turns;
    target.phase_rad.push_back(last);
  }
  if (target.frequency.empty()) throw InputError(points.file, 0, "has no point with a weight above 0");
  return target;
}

void add_mask(CurveTarget& target, const BodePoints& mask, int side) {
  if (mask.points.size() < 2) return;
  for (const Hertz f : log_grid({mask.points.front().frequency, mask.points.back().frequency}, 80)) {
    if (const auto limit = mask_log_gain(mask, std::log(f.rad_s().value)))
      target.masks.push_back({f.rad_s(), *limit, side});
  }
}

CurveTarget thinned(const CurveTarget& full, std::size_t max_points) {
  const std::size_t n = full.frequency.size();
  if (n <= max_points) return full;
  CurveTarget out;
  out.masks = full.masks;
  const double low = std::log(full.frequency.front().value);
  const double high = std::log(full.frequency.back().value);
  std::size_t at = 0;
  for (std::size_t i = 0; i < max_points; ++i) {
    const double log_w = low + (high - low) * static_cast<double>(i) / static_cast<double>(max_points - 1);
    std::size_t next = at;
    while (next + 1 < n && std::log(full.frequency[next].value) < log_w) ++next;
    if (i > 0 && next == at) continue;
    at = next;
    append_point(out, full, at);
  }
  return out;
}

CurveTarget joined(const CurveTarget& points, double weight) {
  CurveTarget out = points;
  for (std::size_t i = 0; i + 1 < points.frequency.size(); ++i) {
    for (int k = 1; k < 8; ++k) {
      const double t = k / 8.0;
      const auto between = [&](double a, double b) { return (1 - t) * a + t * b; };
      out.frequency.push_back(
          {std::exp(between(std::log(points.frequency[i].value), std::log(points.frequency[i + 1].value)))});
      out.log_gain.push_back(between(points.log_gain[i], points.log_gain[i + 1]));
      out.weight.push_back(weight);
      if (points.has_phase()) out.phase_rad.push_back(between(points.phase_rad[i], points.phase_rad[i + 1]));
    }
  }
  return out;
}

double mean_log_gain(const CurveTarget& target) {
  double sum = 0.0;
  double weight = 0.0;
  for (std::size_t i = 0; i < target.frequency.size(); ++i) {
    sum += target.weight[i] * target.log_gain[i];
    weight += target.weight[i];
  }
  return sum / weight;
}

}  // namespace bodesmith
