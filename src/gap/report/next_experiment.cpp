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
  const double most =
      request.duration_s ? DriveRequest::kMostSamples : static_cast<double>(StretchOptions().samples);
  limits.samples =
      static_cast<std::size_t>(std::clamp(request.duration_s.value_or(duration) / limits.step_s, 64.0, most));
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

/// A reference of a part of the range, about its middle.
Drive about_middle(const DriveLimits& limits, const char* kind, double size, double from_hz, double to_hz) {
  const simulate::ReferenceSpec spec{.kind = kind,
                                     .frequency = Hertz{from_hz},
                                     .last = Hertz{to_hz},
                                     .amplitude = size * limits.half(),
                                     .offset = limits.middle(),
                                     .duration_s = limits.duration_s(),
                                     .step_s = limits.step_s};
  return simulate::make_reference(spec).u;
}

using Drives = std::vector<std::pair<std::string, Drive>>;

/// The drives that are tried. A sine of a part of the range may be as much faster within the same rate, to a tenth of
/// the sampling rate.
Drives drives(const DriveLimits& limits) {
  const double full_hz = limits.max_rate / (2.0 * std::numbers::pi * std::max(limits.half(), 1e-300));
  const double slowest_hz = 2.0 / limits.duration_s();
  Drives all;
  const auto add = [&](std::string shape, const Drive& wanted) {
    all.emplace_back(std::move(shape), within_limits(limits, wanted));
  };
  for (const double size : {1.0, 0.3, 0.1}) {
    const std::string of_range = fmt::format("of {:.0f} % of the range", 100.0 * size);
    const double top_hz =
        std::clamp(full_hz / size, 4.0 * slowest_hz, std::max(0.1 / limits.step_s, 4.0 * slowest_hz));
    for (const double part : {1.0, 0.2}) {
      const double to = std::max(part * top_hz, 4.0 * slowest_hz);
      add(fmt::format("multisine {} to {:.3g} Hz", of_range, to),
          about_middle(limits, "multisine", size, slowest_hz, to));
      add(fmt::format("triangles {} at {:.3g} Hz", of_range, 0.5 * to),
          about_middle(limits, "triangle", size, 0.5 * to, to));
    }
    add(fmt::format("sweep {} from {:.3g} to {:.3g} Hz", of_range, slowest_hz, top_hz),
        about_middle(limits, "chirp", size, slowest_hz, top_hz));
  }
  const auto part_of = [&](std::size_t i) {
    return static_cast<double>(i) / static_cast<double>(limits.samples);
  };
  for (const double cycles : {8.0, 24.0}) {
    Drive falling = about_middle(limits, "triangle", 1.0, cycles / limits.duration_s(), 1.0);
    for (std::size_t i = 0; i < falling.size(); ++i)
      falling[i] -= 0.9 * part_of(i) * (falling[i] - limits.middle());
    add(fmt::format("{} triangles of falling size", cycles), falling);
  }
  Drive steps(limits.samples);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    constexpr double kLevels[] = {0.9, 0.0, -0.9, 0.3, -0.3, 0.9, -0.9, 0.0};
    steps[i] = limits.middle() + limits.half() * kLevels[static_cast<std::size_t>(8.0 * part_of(i))];
  }
  add("steps of several sizes, with rests", steps);
  return all;
}

TimeExperiment driven(const DriveLimits& limits, const Drive& u) {
  TimeRecord record;
  record.file = "experiment.csv";
  record.step_s = limits.step_s;
  record.u = u;
  record.y.assign(u.size(), 0.0);
  return TimeExperiment(std::move(record));
}

Eigen::MatrixXd sensitivities_of(const Model& model, const Experiments& experiments) {
  const auto columns = sensitivities(model, experiments);
  Eigen::Index rows = 0;
  for (const auto& c : columns) rows = std::max(rows, c.size());
  Eigen::MatrixXd j = Eigen::MatrixXd::Zero(rows, eigen_index(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k) {
    if (columns[k].size() == rows) j.col(eigen_index(k)) = columns[k];
  }
  return j;
}

/// rms of the rivals' difference under a drive, less what a refit takes away that the training records
/// allow: their normal matrix says how firmly they hold the values.
double told_apart(const Model& model, const Eigen::MatrixXd& held, const TimeExperiment& drive,
                  const std::vector<double>& a, const std::vector<double>& b) {
  Eigen::VectorXd d = as_eigen(a) - as_eigen(b);
  if (model.unknowns().empty()) return d.norm() / std::sqrt(static_cast<double>(d.size()));
  const Eigen::MatrixXd j = sensitivities_of(model, {drive});
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
  auto values = current_values(result.final);
  values[widest.unknown] = widest.low;
  rivals.models[0].set_values(values);
  values[widest.unknown] = widest.high;
  rivals.models[1].set_values(values);
  return rivals;
}

/// How far a drive keeps the rivals apart, whichever of two is refitted.
struct Apart {
  double least = std::numeric_limits<double>::infinity();  ///< rms, of the nearest two
  double told =
      0.0;  ///< sum over all pairs of the logarithm of standard deviations: a pair that no drive separates decides nothing
};

Apart apart_under(const Rivals& rivals, const std::vector<Eigen::MatrixXd>& held, const TimeExperiment& drive,
                  const std::vector<std::vector<double>>& predicted, double noise) {
  Apart out;
  const double root = std::sqrt(static_cast<double>(predicted.front().size()));
  for (std::size_t i = 0; i < rivals.models.size(); ++i) {
    for (std::size_t j = 0; j < rivals.models.size(); ++j) {
      if (i == j) continue;
      const double rms = told_apart(rivals.models[i], held[i], drive, predicted[i], predicted[j]);
      out.least = std::min(out.least, rms);
      out.told += std::log1p(rms * root / noise);
    }
  }
  return out;
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
  for (const Model& model : rivals->models) held.push_back(gram(sensitivities_of(model, study.train())));
  NextExperiment best;
  const double noise = std::max(result.train_rms, 1e-300);
  Apart widest;
  widest.told = -1.0;
  for (auto& [shape, u] : drives(limits)) {
    const auto experiment = driven(limits, u);
    std::vector<std::vector<double>> predicted;
    for (const Model& model : rivals->models) predicted.push_back(bare_output_of(model, experiment));
    const std::size_t samples = u.size();
    if (std::any_of(predicted.begin(), predicted.end(), [&](const auto& y) { return y.size() != samples; }))
      continue;
    // An output as large as what comes: next to one of no size every model seems to run away.
    const Apart apart =
        apart_under(*rivals, held, experiment.with_output(predicted.front()), predicted, noise);
    if (!(apart.told > widest.told)) continue;
    widest = apart;
    best.shape = shape;
    best.u = std::move(u);
    best.predicted = std::move(predicted);
  }
  if (best.u.empty()) return std::nullopt;
  best.step_s = limits.step_s;
  best.rivals = rivals->names;
  best.difference_over_noise = widest.least / noise;
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
