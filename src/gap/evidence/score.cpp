#include "gap/evidence/score.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "gap/effect.hpp"
#include "gap/evidence/names.hpp"
#include "gap/evidence/noise_floor.hpp"
#include "gap/model/model_fit.hpp"
#include "gap/runner.hpp"
#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"
#include "signal/red_noise.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

using Eigen::Index;

/// T. Twice as large: a name must be twice as plain, and a name's odds become their own square root (docs/gap.md).
constexpr double kTemperature = 3.0;

/// What belongs to each record, in the order of the residuals.
std::vector<std::span<double>> by_record(const Experiments& train, std::span<double> residuals) {
  std::vector<std::span<double>> parts;
  std::size_t from = 0;
  for (const auto& e : train) {
    const std::size_t n = std::visit([](const auto& record) { return record.scored(); }, e);
    parts.push_back(residuals.subspan(from, n));
    from += n;
  }
  return parts;
}

/// Degrees of freedom of the innovations' distribution: tails as those of corners and jumps that a model leaves. With 8 they count
/// for more, and smooth lags win over what limits a rate; with infinitely many (Gauss) far more.
constexpr double kDegrees = 4.0;
/// Of their density. Taken once: std::lgamma leaves its sign in a variable that all threads share.
const double kLogShape = std::lgamma(0.5 * (kDegrees + 1.0)) - std::lgamma(0.5 * kDegrees);

/// Log likelihood of independent values under Student's t of the most likely size (Lange, Little, Taylor, J. Am. Stat. Assoc. 84 (1989)
/// 881, whose iteration this is).
double log_of_students_t(std::span<const double> values) {
  const double n = static_cast<double>(values.size());
  double square = std::max(0.5 * rms(values) * rms(values), 1e-300);
  for (double last = 0.0; std::abs(square - last) > 1e-10 * square;) {
    last = square;
    double sum = 0.0;
    for (const double v : values) sum += (kDegrees + 1.0) / (kDegrees + v * v / square) * v * v;
    square = std::max(sum / n, 1e-300);
  }
  double sum = 0.0;
  for (const double v : values) sum += std::log1p(v * v / (kDegrees * square));
  return n * (kLogShape - 0.5 * std::log(kDegrees * std::numbers::pi * square)) -
         0.5 * (kDegrees + 1.0) * sum;
}

/// The noise that a rest is taken for, and how likely it is so. Responses, and rests of rounding, are white.
RedNoise noise_of(const Experiments& train, std::span<double> rest) {
  const double n = static_cast<double>(rest.size());
  const double least = kLeastRest * largest_range(train);
  const double size = std::max(rms({rest.begin(), rest.end()}), least);
  const double log_of_gauss = -0.5 * n * (1.0 + std::log(2.0 * std::numbers::pi));
  RedNoise white{.log_likelihood = log_of_gauss - n * std::log(size), .driving_variance = size * size};
  if (are_responses(train) || size <= least) return white;
  std::vector<std::span<const double>> parts;
  for (const auto& part : by_record(train, rest)) parts.emplace_back(part);
  RedNoise red = most_likely_red_noise(parts, kLongestNoise);
  std::vector<double> innovations(rest.begin(), rest.end());
  for (const auto& part : by_record(train, innovations)) whiten(part, red);
  // Colour has two unknowns of its own (Schwarz).
  red.log_likelihood += log_of_students_t(innovations) - log_of_gauss - std::log(std::max(n, 1.0));
  white.log_likelihood = log_of_students_t(rest);
  return white.log_likelihood >= red.log_likelihood ? white : red;
}

/// Typical changes (Unknown::scale) within which a linear unknown lies beforehand, where its range is wider: with twice as many an
/// offset costs .7 more.
constexpr double kTypicalChanges = 5.0;

/// Standard deviation of an unknown's prior in the coordinate that is searched.
double prior_deviation(const Unknown& u) {
  if (u.given_spread > 0.0) return u.logarithmic ? u.given_spread : u.given_spread / u.scale;
  if (u.logarithmic) return std::log(u.high / u.low) / std::sqrt(12.0);
  return std::min(kTypicalChanges, (u.high - u.low) / u.scale / std::sqrt(12.0));
}

/// A weight that rests at 0 is not there. Beforehand each is there or not with even odds.
bool is_weight(const Unknown& u) {
  return u.low == 0.0 && !u.logarithmic;
}
bool is_in_use(const Unknown& u) {
  return !(is_weight(u) && u.at_bound());
}

/// Of size and phase of each line of the mains, which each record has of its own: an even density over its range.
double occam_of_lines(const Model& model, const Experiments& train, double rest_rms) {
  double sum = 0.0;
  for (const auto& e : train) {
    const auto* time = std::get_if<TimeExperiment>(&e);
    if (time == nullptr) continue;
    const double variance = time->range() * time->range() / 12.0;
    const double known = 0.5 * static_cast<double>(time->scored()) / (kTemperature * rest_rms * rest_rms);
    sum -= static_cast<double>(model.line_blocks().size()) * std::log1p(variance * known);
  }
  return sum;
}

double occam(const Model& model, const Experiments& train, const RedNoise& noise) {
  const auto unknowns = model.unknowns();
  Eigen::MatrixXd columns = sensitivities(model, train);
  for (Index k = 0; k < columns.cols(); ++k) {
    const Unknown& u = unknowns[std_index(k)];
    const double deviation = prior_deviation(u);
    const bool counts = is_in_use(u) && std::isfinite(deviation);
    auto column = to_vector(columns.col(k));
    for (const auto& part : by_record(train, column)) whiten(part, noise);
    columns.col(k) = as_eigen(column) * (counts ? deviation / std::sqrt(kTemperature) : 0.0);
  }
  if (columns.cols() == 0) return 0.0;
  const Eigen::MatrixXd information =
      gram(columns) + Eigen::MatrixXd::Identity(columns.cols(), columns.cols());
  double half_log = 0.0;
  for (const double value : singular_values(information)) half_log += 0.5 * std::log(value);
  return std::isfinite(half_log) ? -half_log : -std::numeric_limits<double>::infinity();
}

/// Of the values that were given beforehand, and of the terms' names and places.
double log_prior(const Model& model) {
  double names = 0.0;
  for (const auto& term : model.terms()) {
    names += term.log_prior;
    for (const auto& u : term.unknowns) names -= is_weight(u) ? std::numbers::ln2 : 0.0;
  }
  double squares = 0.0;
  for (const auto& u : model.unknowns()) {
    if (u.given_spread > 0.0) squares += u.deviations(u.value) * u.deviations(u.value);
  }
  return names - 0.5 * squares;
}

}  // namespace

double log_evidence(const Model& model, const Experiments& train) {
  auto rest = residuals_of(model, train);
  if (rest.empty()) return -std::numeric_limits<double>::infinity();
  const auto noise = noise_of(train, rest);
  const double size = std::max(rms(rest), kLeastRest * largest_range(train));
  return noise.log_likelihood / kTemperature + log_prior(model) + occam(model, train, noise) +
         occam_of_lines(model, train, size);
}

double least_telling_drop(const Experiments& records) {
  return 2.0 * kTemperature * kTied / static_cast<double>(scored_samples(records));
}

double log_share_of_name() {
  return -std::log(static_cast<double>(effect_registry().all().size()));
}

}  // namespace bodesmith::gap
