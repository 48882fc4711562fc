#include "gap/report/next_experiment.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "gap/model/model_fit.hpp"
#include "gap/runner.hpp"
#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"
#include "simulate/references.hpp"

namespace bodesmith::gap {
namespace {

using Drive = std::vector<double>;

struct Rivals {
  std::vector<Model> models;
  std::vector<std::string> names;
};

/// What a drive may be.
struct DriveLimits {
  double low = 0.0;
  double high = 0.0;
  double max_rate = 0.0;  ///< per second
  double step_s = 0.0;
  std::size_t samples = 0;

  double middle() const { return 0.5 * (low + high); }
  double half() const { return 0.5 * (high - low); }
  double duration_s() const { return step_s * static_cast<double>(samples); }
};

const TimeExperiment* first_in_time(const Experiments& experiments) {
  return experiments.empty() ? nullptr : std::get_if<TimeExperiment>(&experiments.front());
}

DriveLimits limits_of(const Experiments& train, const DriveRequest& request) {
  const auto& first = first_in_time(train)->record();
  DriveLimits limits;
  limits.step_s = request.step_s.value_or(first.step_s);
  std::vector<TimeRecord> records;
  for (const Experiment& one : train) records.push_back(std::get<TimeExperiment>(one).record());
  const SignalExtent driven = input_extent(records);
  limits.low = request.lower.value_or(std::min(0.0, driven.lower));
  limits.high = request.upper.value_or(std::max(0.0, driven.upper));
  limits.max_rate = request.max_rate.value_or(driven.max_rate_per_s);
  const double duration = first.step_s * static_cast<double>(first.size());
  limits.samples = static_cast<std::size_t>(std::clamp(request.duration_s.value_or(duration) / limits.step_s,
                                                       double{kLeastSamples}, double{kStretchSamples}));
  return limits;
}

/// A drive of its own, from zero on and no faster than allowed.
Drive within_limits(const DriveLimits& limits, const Drive& wanted) {
  Drive u(limits.samples, std::clamp(0.0, limits.low, limits.high));
  const double step = limits.max_rate * limits.step_s;
  for (std::size_t i = 1; i < u.size(); ++i)
    u[i] = std::clamp(u[i - 1] + std::clamp(wanted[i] - u[i - 1], -step, step), limits.low, limits.high);
  return u;
}

struct TriedDrive {
  std::string shape;
  Drive u;
};

/// References of the whole range and parts of it about its middle, as fast as the rate allows, a part of the range as much faster, to a
/// tenth of the sampling rate; and a fifth as fast.
std::vector<TriedDrive> drives(const DriveLimits& limits) {
  const double full_hz = limits.max_rate / (2.0 * std::numbers::pi * std::max(limits.half(), 1e-300));
  const double slowest_hz = 2.0 / limits.duration_s();
  const double fastest_hz = std::max(0.1 / limits.step_s, 4.0 * slowest_hz);
  std::vector<TriedDrive> all;
  for (const double size : {1.0, 0.3, 0.1}) {
    for (const double part : {1.0, 0.2}) {
      const double top_hz = std::clamp(part * full_hz / size, 4.0 * slowest_hz, fastest_hz);
      for (const auto& [kind, has_band] :
           {std::pair("multisine", true), {"chirp", true}, {"triangle", false}, {"stair", false}}) {
        const simulate::ReferenceSpec spec{.kind = kind,
                                           .frequency = Hertz{has_band ? slowest_hz : 0.5 * top_hz},
                                           .last = Hertz{top_hz},
                                           .amplitude = size * limits.half(),
                                           .offset = limits.middle(),
                                           .duration_s = limits.duration_s(),
                                           .step_s = limits.step_s};
        all.push_back({fmt::format("{} of {:.0f} % of the range, {}{:.3g} Hz", kind, 100.0 * size,
                                   has_band ? "up to " : "", has_band ? top_hz : 0.5 * top_hz),
                       within_limits(limits, simulate::make_reference(spec).u)});
      }
    }
  }
  return all;
}

TimeExperiment driven(const DriveLimits& limits, const Drive& u, std::vector<double> y) {
  TimeRecord record;
  record.file = "experiment.csv";
  record.step_s = limits.step_s;
  record.u = u;
  record.y = std::move(y);
  return TimeExperiment(std::move(record));
}

/// rms of the rivals' difference under a drive, less what a refit takes away that the training records
/// allow: their normal matrix says how firmly they hold the values.
double told_apart(const Model& model, const Eigen::MatrixXd& held, const TimeExperiment& drive,
                  const std::vector<double>& a, const std::vector<double>& b) {
  Eigen::VectorXd d = as_eigen(a) - as_eigen(b);
  if (model.unknowns().empty()) return d.norm() / std::sqrt(static_cast<double>(d.size()));
  const Eigen::MatrixXd j = sensitivities(model, {drive});
  if (j.rows() != d.size()) return 0.0;
  Eigen::MatrixXd normal = gram(j) + held;
  normal.diagonal().array() *= 1.0 + 1e-9;
  const Eigen::VectorXd refit = solve_ldlt(normal, transpose_times(j, d));
  if (refit.allFinite()) d -= times(j, refit);
  return d.norm() / std::sqrt(static_cast<double>(d.size()));
}

std::optional<Rivals> rivals_of(const SearchResult& result, const std::vector<OpenParameter>& open) {
  for (auto step = result.steps.rbegin(); step != result.steps.rend(); ++step) {
    if (step->tied_with.empty()) continue;
    Rivals rivals{{step->after}, {std::string(step->effect->told())}};
    for (const auto& r : step->ranking) {
      const std::string name(r.effect->told());
      if (r.outcome != CandidateOutcome::tied ||
          std::find(rivals.names.begin(), rivals.names.end(), name) != rivals.names.end())
        continue;
      rivals.models.push_back(r.model);
      rivals.names.push_back(name);
    }
    if (rivals.models.size() > 1) return rivals;
  }
  if (open.empty()) return std::nullopt;
  const auto& widest = *std::max_element(open.begin(), open.end(), [](const auto& a, const auto& b) {
    return std::abs(a.high - a.low) * std::abs(b.high + b.low) <
           std::abs(b.high - b.low) * std::abs(a.high + a.low);
  });
  Rivals rivals{{result.final, result.final}, {widest.name + "_low", widest.name + "_high"}};
  auto values = result.final.values();
  values[widest.unknown] = widest.low;
  rivals.models[0].set_values(values);
  values[widest.unknown] = widest.high;
  rivals.models[1].set_values(values);
  return rivals;
}

}  // namespace

std::optional<NextExperiment> next_experiment(const SearchResult& result,
                                              const std::vector<OpenParameter>& open, const Study& study,
                                              const DriveRequest& request) {
  if (first_in_time(study.train()) == nullptr) return std::nullopt;
  const auto rivals = rivals_of(result, open);
  if (!rivals) return std::nullopt;
  const auto limits = limits_of(study.train(), request);
  if (!(limits.high > limits.low)) return std::nullopt;
  std::vector<Eigen::MatrixXd> held;
  for (const Model& model : rivals->models) held.push_back(gram(sensitivities(model, study.train())));
  NextExperiment best;
  best.step_s = limits.step_s;
  best.rivals = rivals->names;
  const double noise = std::max(result.train_rms, 1e-300);
  const std::size_t count = rivals->models.size();
  double most_told = -1.0;
  for (auto& [shape, u] : drives(limits)) {
    const auto experiment = driven(limits, u, std::vector<double>(u.size(), 0.0));
    std::vector<std::vector<double>> predicted;
    for (const Model& model : rivals->models) predicted.push_back(bare_output_of(model, experiment));
    const std::size_t samples = u.size();
    if (std::ranges::any_of(predicted, [&](const auto& y) { return y.size() != samples; })) continue;
    // An output as large as what comes: next to one of no size every model seems to run away.
    const auto as_large = driven(limits, u, predicted.front());
    // rms of the nearest two; and the logarithm of standard deviations over all pairs: one that no drive separates decides nothing.
    double least = std::numeric_limits<double>::infinity(), told = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = 0; j < count; ++j) {
        if (i == j) continue;
        const double rms = told_apart(rivals->models[i], held[i], as_large, predicted[i], predicted[j]);
        least = std::min(least, rms);
        told += std::log1p(rms * std::sqrt(static_cast<double>(samples)) / noise);
      }
    }
    if (!(told > most_told)) continue;
    most_told = told;
    best.shape = shape;
    best.u = std::move(u);
    best.predicted = std::move(predicted);
    best.difference_over_noise = least / noise;
  }
  if (best.u.empty()) return std::nullopt;
  return best;
}

std::string to_csv(const NextExperiment& experiment) {
  std::string text = "time_s,u";
  for (const auto& name : experiment.rivals) text += ",y_" + name;
  text += '\n';
  for (std::size_t i = 0; i < experiment.u.size(); ++i) {
    text += fmt::format("{:.12g},{:.12g}", experiment.step_s * static_cast<double>(i), experiment.u[i]);
    for (const auto& y : experiment.predicted) text += fmt::format(",{:.9g}", y[i]);
    text += '\n';
  }
  return text;
}

}  // namespace bodesmith::gap
