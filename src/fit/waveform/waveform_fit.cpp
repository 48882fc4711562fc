#include "fit/waveform/waveform_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "fit/cascade/cascade_fit.hpp"
#include "fit/direct/curve_target.hpp"
#include "fit/direct/start_builder.hpp"
#include "fit/waveform/waveform_problem.hpp"
#include "lti/section_making.hpp"
#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"
#include "numeric/optimisation/constrained_programs.hpp"
#include "numeric/optimisation/minimum.hpp"

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
    p.a.block(i, 0, 1, n) = (2.0 * radius / worst) * transpose_times(slope, e).transpose();
    p.a(i, n) = -1.0;
    p.b(i) = -e.squaredNorm() / worst;
    p.q.topLeftCorner(n, n) += (2.0 * share(i) * radius * radius / worst) * gram(slope);
  }
  p.a.bottomLeftCorner(box.b.size(), n) = box.a;
  p.b.tail(box.b.size()) = box.b;
  return p;
}

/// The largest mean square error over the operating frequencies made smallest: sequential quadratic programming with
/// Gauss-Newton curvature in a trust region. `value` is its root.
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

using Branch = Disturbance::Branch;
using Eigen::MatrixXd;
using Eigen::VectorXd;

void validate_path(const Disturbance& disturbance, DrivenPath path) {
  const bool up = disturbance.is_static(Branch::ascending);
  const bool down = disturbance.is_static(Branch::descending);
  if ((path == DrivenPath::ascending && up) || (path == DrivenPath::descending && down) || (up && down)) {
    throw InputError(
        "the rate gains of this path are 1 at every frequency, expected a branch that needs a compensator");
  }
}

/// The gain that the path should have at a frequency, as far as one number says it.
double rate_gain_of_path(const Disturbance& disturbance, DrivenPath path, Hertz f) {
  return disturbance.rate_gain(path == DrivenPath::ascending ? Branch::ascending : Branch::descending, f);
}

struct WaveformSearch {
  RootModel model;
  SearchResult best;
  int tried = 0;
};

/// The best of many starts, real roots and (unless only those are asked for) pairs.
WaveformSearch search_waveform(const WaveformProblem& problem, const WaveformFitOptions& options) {
  const double lowest = problem.operating().front().rad_s().value;
  const double highest = problem.operating().back().rad_s().value;
  const RadPerSecond reference{std::sqrt(lowest * highest)};
  RootLimits limits{.low = {lowest / 100.0}, .high = {highest * 1000.0}, .min_damping = options.min_damping};
  const auto improve = [&](const RootModel& model, const VectorXd& start, int iterations) {
    const ErrorFunction errors_at = [&](const VectorXd& at, VectorXd& error, MatrixXd* slope) {
      problem.errors(model, at, error, slope);
    };
    return search_least_squares(model, errors_at, limits, start, iterations);
  };
  StartBuilder::Settings settings;
  settings.low = {lowest / 2.0};
  settings.high = {highest * 20.0};
  settings.random = options.starts;
  settings.seed = options.seed;
  settings.kept = 5;

  WaveformSearch out;
  out.best.value = INFINITY;
  for (const bool real : options.real ? std::vector<bool>{true} : std::vector<bool>{true, false}) {
    settings.real = real;
    StartBuilder builder(
        settings, [&](const RootModel& model, const VectorXd& start) { return improve(model, start, 25); });
    const RootModel model = StartBuilder::make_model(options.order, options.order, real, reference);
    for (const SearchResult& start : builder.build(options.order, options.order, reference)) {
      SearchResult result = options.worst ? search_smallest_worst(problem, model, limits, start.theta, 150)
                                          : improve(model, start.theta, 300);
      if (result.value < out.best.value) {
        out.best = std::move(result);
        out.model = model;
      }
    }
    out.tried += builder.tried();
  }
  return out;
}

/// The best fixed gain: a convex function of one number.
double best_constant_gain(const Disturbance& disturbance, const std::vector<Hertz>& operating,
                          const WaveformFitOptions& options) {
  const auto value_at = [&](double gain) {
    const WaveformError error = waveform_error([&](RadPerSecond) { return Complex(gain, 0.0); }, disturbance,
                                               operating, {.path = options.path, .harmonics = 16});
    return options.worst ? error.worst_percent : error.rms_percent;
  };
  constexpr double kMostGain = 3.0;
  return minimum_between(0.0, kMostGain, 1e-6, value_at);
}

/// The fractional cascade interpolated through the rate gains; nothing when fewer than two are above 0.
std::optional<Cascade> magnitude_only_cascade(const Disturbance& disturbance,
                                              const std::vector<Hertz>& operating, DrivenPath path) {
  BodePoints points;
  for (const Hertz f : operating) {
    const double gain = rate_gain_of_path(disturbance, path, f);
    if (gain > 0.0) points.points.push_back({f, gain, std::nullopt, 1.0, 0});
  }
  if (points.points.size() < 2) return std::nullopt;
  return fit_cascade(points).cascade;
}

std::vector<Hertz> frequencies_between(const std::vector<Hertz>& operating) {
  std::vector<Hertz> out;
  for (std::size_t i = 0; i + 1 < operating.size(); ++i)
    out.push_back({std::sqrt(operating[i].value * operating[i + 1].value)});
  return out;
}

/// Differences from the rate gains, for what reads sections without a waveform.
Sections::Error gain_error(const Sections& sections, const Disturbance& disturbance,
                           const std::vector<Hertz>& operating, DrivenPath path) {
  double magnitude = 0.0;
  double phase = 0.0;
  for (const Hertz f : operating) {
    const Complex g = sections.response(f.rad_s());
    const double target = rate_gain_of_path(disturbance, path, f);
    magnitude = std::max(magnitude, std::abs(to_decibel(std::abs(g) / target)));
    phase = std::max(phase, std::abs(to_degrees(std::arg(g))));
  }
  return {{operating.front(), operating.back()}, magnitude, phase, magnitude};
}

std::vector<std::string> waveform_warnings(const WaveformFit& fit) {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < fit.between.points.size(); ++i) {
    const WaveformErrorPoint& with = fit.between.points[i];
    const WaveformErrorPoint& without = fit.between_none.points[i];
    if (with.rms_percent <= without.rms_percent) continue;
    out.push_back(fmt::format(
        "between the operating frequencies, at {} Hz, the filter leaves {} % and no compensation {} %",
        rounded_text(with.frequency.value, 3), rounded_text(with.rms_percent, 3),
        rounded_text(without.rms_percent, 3)));
  }
  return out;
}

}  // namespace

DrivenPath path_to_compensate(const Disturbance& disturbance) {
  const bool up = !disturbance.is_static(Branch::ascending);
  const bool down = !disturbance.is_static(Branch::descending);
  if (!up && !down)
    throw InputError("the rate gains of both branches are 1, expected a branch that needs a compensator");
  if (up && !down) return DrivenPath::ascending;
  if (down && !up) return DrivenPath::descending;
  if (disturbance.rate.ascending == disturbance.rate.descending) return DrivenPath::whole;
  throw InputError(
      "the two branches have different rate gains, expected a choice of branch (each needs its own filter)");
}

WaveformSections fit_waveform_sections(const Disturbance& disturbance, const WaveformFitOptions& options) {
  if (options.order < 1 || options.order > 6)
    throw InputError(fmt::format("the order is {}, expected 1 to 6", options.order));
  const std::vector<Hertz> operating = checked_operating(disturbance, options.operating);
  validate_path(disturbance, options.path);
  const WaveformProblem problem(disturbance, operating, options.path);
  const WaveformSearch search = search_waveform(problem, options);
  if (!std::isfinite(search.best.value) || search.best.theta.size() == 0)
    throw DesignError(
        "no waveform fit is finite: the numbers of the disturbance lie too far apart for double precision");
  const RootModel::Roots roots = search.model.roots(search.best.theta);
  WaveformSections out{make_sections(roots.gain, roots.zeros, roots.poles), search.tried};
  out.sections.error = gain_error(out.sections, disturbance, operating, options.path);
  return out;
}

WaveformFit fit_waveform(const Disturbance& disturbance, const WaveformFitOptions& options) {
  WaveformSections fitted = fit_waveform_sections(disturbance, options);
  const std::vector<Hertz> operating = checked_operating(disturbance, options.operating);
  WaveformFit out;
  out.starts_tried = fitted.starts_tried;
  out.sections = std::move(fitted.sections);
  out.constant_gain = best_constant_gain(disturbance, operating, options);
  const auto error_of = [&](const FrequencyResponse& g, const std::vector<Hertz>& at) {
    return waveform_error(g, disturbance, at, {.path = options.path});
  };
  const FrequencyResponse filter = [&](RadPerSecond w) { return out.sections.response(w); };
  const FrequencyResponse none = [](RadPerSecond) { return Complex(1.0, 0.0); };
  out.error = error_of(filter, operating);
  out.none = error_of(none, operating);
  out.constant = error_of([&](RadPerSecond) { return Complex(out.constant_gain, 0.0); }, operating);
  if (const auto between = frequencies_between(operating); !between.empty()) {
    out.between = error_of(filter, between);
    out.between_none = error_of(none, between);
  }
  if (const auto cascade = magnitude_only_cascade(disturbance, operating, options.path))
    out.magnitude_only = error_of([&](RadPerSecond w) { return cascade->response(w); }, operating);
  out.lower_bound_percent = waveform_lower_bound(disturbance, operating, options.path, options.worst);
  out.warnings = waveform_warnings(out);
  return out;
}

}  // namespace bodesmith
