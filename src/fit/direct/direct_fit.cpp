#include "fit/direct/direct_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "base/text.hpp"
#include "fit/direct/constrained_search.hpp"
#include "fit/direct/curve_target.hpp"
#include "fit/direct/group_moves.hpp"
#include "fit/direct/rational_start.hpp"
#include "fit/direct/start_builder.hpp"
#include "lti/section_making.hpp"
#include "numeric/parallel_for.hpp"

namespace bodesmith {
namespace {

using Eigen::VectorXd;

constexpr std::size_t kMaxScreeningPoints = 160;  ///< dense curves are thinned while starts are screened
constexpr std::size_t kMaxFinalPoints = 3000;
constexpr double kJoiningWeight = 0.02;  ///< between the points of an underdetermined fit
constexpr double kExactFit = 1e-7;       ///< Np: no other kind of roots can do better
constexpr double kNearlyExact = 1e-4;    ///< Np

void validate_options(const DirectFitOptions& options) {
  if (options.order < 1 || options.order > 12)
    throw InputError(fmt::format("the order is {}, expected 1 to 12", options.order));
  if (options.relative_degree < 0 || options.relative_degree > options.order) {
    throw InputError(fmt::format("the relative degree is {}, expected 0 to the order {}",
                                 options.relative_degree, options.order));
  }
}

/// All that the searches of one fit share.
struct DirectProblem {
  CurveTarget target;
  CurveTarget screening;
  RootLimits limits;
  StartBuilder::Settings starts;
  RadPerSecond reference{1.0};
  int zeros = 0;
  bool underdetermined = false;  ///< no more points than free numbers
};

CurveTarget masked_target(const BodePoints& points, const DirectFitOptions& options) {
  CurveTarget target = make_curve_target(points, options.use_phase);
  if (options.upper) add_mask(target, *options.upper, 1);
  if (options.lower) add_mask(target, *options.lower, -1);
  return thinned(target, kMaxFinalPoints);
}

RootLimits root_limits(RadPerSecond lowest, RadPerSecond highest, const DirectFitOptions& options) {
  RootLimits limits;
  limits.low = {lowest.value / 1000.0};
  limits.high = {options.max_corner ? options.max_corner->rad_s().value : highest.value * 1000.0};
  if (limits.high.value <= limits.low.value) limits.low = {limits.high.value / 1e4};
  limits.min_damping = options.min_damping;
  return limits;
}

DirectProblem make_direct_problem(const BodePoints& points, const DirectFitOptions& options) {
  DirectProblem out;
  out.target = masked_target(points, options);
  const RadPerSecond lowest = out.target.frequency.front();
  const RadPerSecond highest = out.target.frequency.back();
  out.limits = root_limits(lowest, highest, options);
  out.reference = {std::sqrt(lowest.value * highest.value)};
  out.zeros = options.order - options.relative_degree;
  const RootModel model = StartBuilder::make_model(out.zeros, options.order, true, out.reference);
  out.underdetermined = std::ssize(out.target.frequency) <= model.size();
  out.screening =
      out.underdetermined ? joined(out.target, kJoiningWeight) : thinned(out.target, kMaxScreeningPoints);
  // Roots begin within a factor of e of the points.
  const double low = out.limits.low.value;
  const double high = out.limits.high.value;
  out.starts.low = {std::clamp(lowest.value / std::numbers::e, low, high / 3.0)};
  out.starts.high = {std::clamp(highest.value * std::numbers::e, out.starts.low.value * 2.0, high)};
  out.starts.log_gain = mean_log_gain(out.target);
  out.starts.random = options.starts;
  out.starts.kept = out.underdetermined ? 8 : 16;
  out.starts.seed = options.seed;
  return out;
}

struct DirectSearch {
  RootModel model;
  SearchResult best;
  int tried = 0;
  int left = 0;  ///< starts that were not followed when the deadline passed
};

/// Whether no fit of these orders can be noticeably better, masks or not.
bool is_best_possible(const DirectProblem& problem, const DirectSearch& search) {
  constexpr double kProven = 0.999;
  constexpr double kRoundedData = 1e-6;  // Np: what nine digits of a gain leave open
  return search.best.value < kRoundedData ||
         alternation_bound(search.model, problem.target, search.best.theta) >= kProven * search.best.value;
}

/// A start on the way to its end.
struct Followed {
  SearchResult result;
  double radius = kFirstRadius;
};

/// One screened start, nearly to its end.
Followed refine_start(const DirectProblem& problem, const RootModel& model, const SearchResult& start,
                      bool least_squares) {
  // finish_starts() follows the promising ones to their end; few points leave nothing to tell them apart by.
  const int iterations = problem.underdetermined ? 80 : 20;
  Followed out;
  SearchResult near = search_constrained(model, problem.screening, problem.limits, start.theta, true, 30);
  if (problem.underdetermined && problem.target.masks.empty())
    near = search_interpolation(model, problem.target, problem.limits, near.theta, 60);
  if (problem.underdetermined && near.value <= 1e-6) return {std::move(near), kFirstRadius};
  out.result = search_constrained(model, problem.target, problem.limits, near.theta, least_squares,
                                  iterations, out.radius);
  return out;
}

/// To their end those that are not far from the best.
void finish_starts(const DirectProblem& problem, const RootModel& model, bool least_squares,
                   std::vector<Followed>& refined) {
  constexpr double kFar = 1.5;
  if (problem.underdetermined) return;
  double best = INFINITY;
  for (const Followed& one : refined) best = std::min(best, one.result.value);
  parallel_for(refined.size(), thread_count(0), [&](std::size_t i) {
    Followed& one = refined[i];
    if (one.result.theta.size() == 0 || !(one.result.value <= kFar * best)) return;
    stop_if_interrupted();
    one.result = search_constrained(model, problem.target, problem.limits, one.result.theta, least_squares,
                                    60, one.radius);
  });
}

/// One start without a search: if what it ends in is provably as good as can be, there is nothing to search for.
/// Pairs reach every kind of root; real ones are tried where pairs end elsewhere.
std::optional<DirectSearch> search_from_rational(const DirectProblem& problem,
                                                 const DirectFitOptions& options) {
  if (problem.underdetermined || options.use_phase || options.least_squares) return std::nullopt;
  std::optional<DirectSearch> out;
  for (const bool real : options.real ? std::vector<bool>{true} : std::vector<bool>{false, true}) {
    stop_if_interrupted();
    const RootModel model = StartBuilder::make_model(problem.zeros, options.order, real, problem.reference);
    const auto theta = rational_start(model, problem.screening, problem.limits);
    if (!theta) continue;
    const SearchResult near = search_least_squares(model, problem.screening, problem.limits, *theta, 20);
    for (const VectorXd& start : {*theta, near.theta}) {
      SearchResult result = search_constrained(model, problem.target, problem.limits, start, false, 80);
      // Nearly exact: the curve is one of these, and least squares converge faster.
      if (result.value < kNearlyExact) {
        const SearchResult closer =
            search_least_squares(model, problem.target, problem.limits, result.theta, 200);
        SearchResult again =
            search_constrained(model, problem.target, problem.limits, closer.theta, false, 80);
        if (again.value < result.value) result = std::move(again);
      }
      const int tried = out ? out->tried + 1 : 1;
      if (!out || result.value < out->best.value * (1.0 - 1e-6))
        out = DirectSearch{model, std::move(result), tried};
      out->tried = tried;
      if (is_best_possible(problem, *out)) return out;
    }
  }
  return out;
}

/// How much a search from many starts does. One that has a good fit already looks for other valleys only.
struct SearchEffort {
  bool both_kinds = true;  ///< real roots as well as pairs
  int random = 24;
  int iterations = 40;        ///< of a start that is screened
  std::size_t finished = 99;  ///< so many of the screened ones are refined to the end
};

SearchEffort effort_of(const DirectProblem& problem, const DirectFitOptions& options,
                       const std::optional<DirectSearch>& have) {
  // Far from its bound a fit stands in the wrong valley, or at a limit that the bound knows nothing of.
  constexpr double kNear = 0.5;
  const bool near =
      have && alternation_bound(have->model, problem.target, have->best.theta) > kNear * have->best.value;
  if (!near) return {true, options.starts, 40, 99};
  return {false, options.starts / 3, 20, 8};
}

/// The best of many starts. Pairs reach real roots too, but their seam is hard to cross: complex fits try real ones as
/// well.
DirectSearch search_from_starts(const DirectProblem& problem, const DirectFitOptions& options,
                                const SearchEffort& effort) {
  DirectSearch out;
  out.best.value = INFINITY;
  StartBuilder::Settings settings = problem.starts;
  std::vector<bool> kinds = {options.real};
  if (!options.real && effort.both_kinds) kinds.push_back(true);
  for (const bool real : kinds) {
    if (out.best.value < kExactFit) break;
    settings.real = real;
    settings.random = real && !options.real ? effort.random / 4 : effort.random;
    StartBuilder builder(settings, [&](const RootModel& model, const VectorXd& start) {
      constexpr int kHurried = 3;
      const int iterations = options.deadline.passed() ? kHurried : effort.iterations;
      return search_least_squares(model, problem.screening, problem.limits, start, iterations);
    });
    const RootModel model = StartBuilder::make_model(problem.zeros, options.order, real, problem.reference);
    std::vector<SearchResult> starts = builder.build(problem.zeros, options.order, problem.reference);
    const bool screen = starts.size() > effort.finished;
    std::vector<Followed> refined(starts.size());
    std::atomic<int> left{0};
    Progress progress("starts of the fit");
    std::atomic<std::size_t> begun = 0;
    parallel_for(starts.size(), thread_count(0), [&](std::size_t i) {
      stop_if_interrupted();
      progress.at(static_cast<double>(begun++) / static_cast<double>(starts.size()));
      // The first one is followed however late it is: there is an answer.
      if (i > 0 && options.deadline.passed()) {
        ++left;
        refined[i].result.value = INFINITY;
        return;
      }
      if (screen) {
        refined[i].result =
            search_constrained(model, problem.screening, problem.limits, starts[i].theta, false, 40);
      } else {
        refined[i] = refine_start(problem, model, starts[i], options.least_squares);
      }
    });
    if (!screen) {
      if (!options.deadline.passed()) finish_starts(problem, model, options.least_squares, refined);
    } else {
      std::ranges::stable_sort(
          refined, [](const Followed& a, const Followed& b) { return a.result.value < b.result.value; });
      refined.resize(effort.finished);
      parallel_for(refined.size(), thread_count(0), [&](std::size_t i) {
        SearchResult& one = refined[i].result;
        if (one.theta.size() == 0) return;
        one = search_constrained(model, problem.target, problem.limits, one.theta, false, 80);
      });
    }
    for (Followed& followed : refined) {
      SearchResult& result = followed.result;
      if (result.value < out.best.value * (1.0 - 1e-6)) {
        out.best = std::move(result);
        out.model = model;
      }
    }
    out.tried += builder.tried();
    out.left += left;
  }
  return out;
}

/// The best once more, with steps as long as at the beginning: some end where a short step finds nothing.
SearchResult polished(const DirectProblem& problem, const RootModel& model, bool least_squares,
                      SearchResult best) {
  constexpr int kTimes = 3;
  constexpr double kWorth = 1e-6;
  for (int i = 0; i < kTimes; ++i) {
    SearchResult again =
        search_constrained(model, problem.target, problem.limits, best.theta, least_squares, 60);
    if (!(again.value < best.value)) break;
    const bool done = again.value > best.value * (1.0 - kWorth);
    best = std::move(again);
    if (done) break;
  }
  return best;
}

/// What the sections do at every point (those of weight 0 too, which count for nothing else).
void compare_with_points(DirectFit& fit, const BodePoints& points) {
  double square = 0.0;
  double weight = 0.0;
  for (const BodePoint& point : points.points) {
    const double target = to_decibel(point.gain);
    const double got = to_decibel(std::abs(fit.sections.response(point.frequency.rad_s())));
    fit.points.push_back({point.frequency, target, got});
    if (point.weight == 0.0) continue;
    fit.max_db = std::max(fit.max_db, std::abs(got - target));
    square += point.weight * (got - target) * (got - target);
    weight += point.weight;
  }
  fit.rms_db = std::sqrt(square / weight);
}

double max_phase_error_deg(const BodePoints& points, const RootModel& model, const VectorXd& theta) {
  const CurveTarget all = make_curve_target(points, true);
  double worst = 0.0;
  for (std::size_t i = 0; i < all.frequency.size(); ++i) {
    const double phase = model.log_response(theta, all.frequency[i]).imag();
    worst = std::max(worst, std::abs(to_degrees(phase - all.phase_rad[i])));
  }
  return worst;
}

double max_mask_violation_db(const CurveTarget& target, const RootModel& model, const VectorXd& theta) {
  double worst = 0.0;
  for (const CurveTarget::Mask& mask : target.masks) {
    const double over = mask.side * (model.log_response(theta, mask.frequency).real() - mask.log_gain);
    worst = std::max(worst, kDecibelPerNeper * over);
  }
  return worst;
}

/// Largest gain between the highest point and two decades above the highest corner allowed, relative to the largest
/// point.
double highest_gain_above(const Sections& sections, const BodePoints& points, const DirectProblem& problem) {
  double loudest = -INFINITY;
  for (const BodePoint& point : points.points) loudest = std::max(loudest, to_decibel(point.gain));
  const RadPerSecond highest = problem.target.frequency.back();
  const Hertz end{std::max(problem.limits.high.value, highest.value) / 6.0 * 100.0};
  double out = -INFINITY;
  for (const Hertz f : log_grid({highest.hz(), end}, 300))
    out = std::max(out, to_decibel(std::abs(sections.response(f.rad_s()))) - loudest);
  return out;
}

std::vector<std::string> direct_warnings(const DirectFit& fit, const DirectProblem& problem) {
  constexpr double kLoud = 6.0;  // dB above the points: twice their largest gain
  std::vector<std::string> out;
  if (fit.highest_gain_above_band_db > kLoud) {
    out.push_back(
        fmt::format("above the points the gain rises {} dB over the largest of them: set a highest corner "
                    "frequency",
                    rounded_text(fit.highest_gain_above_band_db, 3)));
  }
  if (problem.underdetermined) {
    out.push_back(fmt::format(
        "{} points for {} free numbers: between the points the curve is only kept near straight lines",
        problem.target.frequency.size(), fit.parameters));
  }
  if (fit.mask_violation_db > 1e-6)
    out.push_back(fmt::format("a mask is missed by {} dB", rounded_text(fit.mask_violation_db, 3)));
  return out;
}

}  // namespace

DirectFit fit_directly(const BodePoints& points, const DirectFitOptions& options) {
  validate_options(options);
  const DirectProblem problem = make_direct_problem(points, options);
  std::optional<DirectSearch> rational = search_from_rational(problem, options);
  const bool proven = rational && is_best_possible(problem, *rational);
  DirectSearch search =
      proven ? *rational : search_from_starts(problem, options, effort_of(problem, options, rational));
  if (rational && !proven) {
    search.tried += rational->tried;
    if (rational->best.value < search.best.value) {
      search.best = std::move(rational->best);
      search.model = rational->model;
    }
  }
  DirectFit out;
  out.starts_tried = search.tried;
  if (!std::isfinite(search.best.value) || search.best.theta.size() == 0)
    throw DesignError(
        "no fit to these points has finite gains: their numbers lie too far apart for double precision");
  if (search.left > 0)
    out.not_tried.push_back(fmt::format("{} of the starting points were not followed", search.left));
  if (!problem.underdetermined && !proven && options.deadline.passed()) {
    out.not_tried.emplace_back("groups of roots were not moved together");
  } else if (!problem.underdetermined && !proven) {
    GroupMoves moves(search.model, problem.limits, problem.starts, problem.screening, problem.target,
                     options.least_squares);
    search.best =
        polished(problem, search.model, options.least_squares, moves.improve(std::move(search.best)));
    out.starts_tried += moves.tried();
  }
  RootModel::Roots roots = search.model.roots(search.best.theta);
  const double value_db = kDecibelPerNeper * search.best.value;
  out.cancelled = drop_cancelling(roots, problem.target, value_db);
  // Masks and phases see more of a distant zero than the points' gains do.
  if (problem.target.masks.empty() && !options.use_phase) {
    out.distant_zeros = drop_distant_zeros(roots, problem.target, value_db);
    out.zeros_at_origin = move_zeros_to_origin(roots, problem.target, value_db);
  }
  out.sections = make_sections(roots.gain, roots.zeros, roots.poles);
  out.parameters = static_cast<int>(search.model.size());
  compare_with_points(out, points);
  if (options.use_phase) out.max_phase_deg = max_phase_error_deg(points, search.model, search.best.theta);
  out.mask_violation_db = max_mask_violation_db(problem.target, search.model, search.best.theta);
  out.highest_gain_above_band_db = highest_gain_above(out.sections, points, problem);
  out.warnings = direct_warnings(out, problem);
  out.sections.error = Sections::Error{{points.points.front().frequency, points.points.back().frequency},
                                       out.max_db,
                                       options.use_phase ? std::optional(out.max_phase_deg) : std::nullopt,
                                       out.max_db};
  return out;
}

DirectFit fit_directly_within(const BodePoints& points, DirectFitOptions options, double limit_db,
                              int min_order, int max_order) {
  DirectFit fit;
  for (options.order = min_order; options.order <= max_order; ++options.order) {
    fit = fit_directly(points, options);
    if (fit.max_db <= limit_db) break;
    if (options.order < max_order && options.deadline.passed()) {
      fit.not_tried.push_back(fmt::format("orders above {}", options.order));
      break;
    }
  }
  return fit;
}

}  // namespace bodesmith
