#include "fit/cascade/cascade_bands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.hpp"

namespace bodesmith {
namespace {

constexpr double kMaxCandidates = 40.0;  ///< of band ends, when the fewest are looked for
constexpr double kMaxChoices = 3e5;      ///< times points: how much trying out is worth (about a second)
constexpr std::size_t kMaxBands = 16;    ///< when bands are added one by one

LongMatrix make_matrix(const std::vector<FractionalLeadLag>& bands, const std::vector<BodePoint>& above) {
  LongMatrix a;
  for (const BodePoint& point : above) {
    LongVector row;
    for (const FractionalLeadLag& band : bands) row.push_back(band.log_magnitude(point.frequency.rad_s()));
    a.push_back(std::move(row));
  }
  return a;
}

/// Each row and its right side times the root of the point's weight.
void weigh_rows(LongMatrix& matrix, LongVector& target, const std::vector<BodePoint>& points) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const long double root = std::sqrt(static_cast<long double>(points[i].weight));
    for (long double& value : matrix[i]) value *= root;
    target[i] *= root;
  }
}

double max_error_db(const BandSolution& solution, const CascadeProblem& problem) {
  double worst = 0.0;
  for (const BodePoint& point : problem.above) {
    if (point.weight == 0.0) continue;
    worst = std::max(worst, std::abs(solution.curve_db(point.frequency) - problem.target_db(point)));
  }
  return worst;
}

/// Indices of the inner band ends among the candidates, rising.
using InnerEnds = std::vector<std::size_t>;

/// The next choice of as many among n in lexical order; false after the last.
bool next_choice(InnerEnds& inner, std::size_t n) {
  const std::size_t k = inner.size();
  std::size_t i = k;
  while (i > 0 && inner[i - 1] == n - k + i - 1) --i;
  if (i == 0) return false;
  ++inner[i - 1];
  for (std::size_t j = i; j < k; ++j) inner[j] = inner[j - 1] + 1;
  return true;
}

/// Tries sets of band ends: candidates, of which the last point of the problem always is one.
class BandTrials {
 public:
  BandTrials(const CascadeProblem& problem, const CascadeFitOptions& options)
      : problem_(problem), options_(options) {
    // Thinned evenly in log frequency when there are many points.
    const double span = std::log(problem.above.back().frequency.value / problem.base.value);
    double next = 0.0;
    for (const BodePoint& point : problem.above) {
      const bool last = &point == &problem.above.back();
      const double at = std::log(point.frequency.value / problem.base.value);
      if (at < next - 1e-12 && !last) continue;
      candidates_.push_back(point);
      next = at + span / kMaxCandidates;
    }
    last_ = candidates_.back();
    candidates_.pop_back();
  }

  struct Trial {
    InnerEnds inner;
    double error_db = INFINITY;
  };

  std::size_t candidates() const { return candidates_.size(); }

  std::vector<BodePoint> ends(const InnerEnds& inner) const {
    std::vector<BodePoint> out;
    for (const std::size_t i : inner) out.push_back(candidates_[i]);
    out.push_back(last_);
    return out;
  }
  Trial evaluate(const InnerEnds& inner) const {
    return {inner, max_error_db(solve_bands(problem_, ends(inner), problem_.above, options_), problem_)};
  }

  /// The best choice of k inner ends.
  Trial best_of_all(std::size_t k) const {
    InnerEnds inner(k);
    std::iota(inner.begin(), inner.end(), std::size_t{0});
    Trial best;
    do {
      Trial trial = evaluate(inner);
      if (trial.error_db < best.error_db) best = std::move(trial);
    } while (next_choice(inner, candidates()));
    return best;
  }

  /// One inner end more, where it helps most.
  Trial best_with_one_more(const InnerEnds& inner) const {
    Trial best;
    for (std::size_t i = 0; i < candidates(); ++i) {
      if (std::ranges::find(inner, i) != inner.end()) continue;
      InnerEnds more = inner;
      more.insert(std::upper_bound(more.begin(), more.end(), i), i);
      Trial trial = evaluate(more);
      if (trial.error_db < best.error_db) best = std::move(trial);
    }
    return best;
  }

  /// Takes away what does not matter for the limit.
  InnerEnds without_needless(InnerEnds inner, double limit_db) const {
    for (std::size_t i = 0; i < inner.size();) {
      InnerEnds fewer = inner;
      fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(i));
      if (evaluate(fewer).error_db <= limit_db)
        inner = std::move(fewer);
      else
        ++i;
    }
    return inner;
  }

 private:
  const CascadeProblem& problem_;
  const CascadeFitOptions& options_;
  std::vector<BodePoint> candidates_;
  BodePoint last_;
};

/// Every choice of 0, 1, 2, ... inner ends, as long as there are not too many; nothing when none of those is within the
/// limit.
std::optional<InnerEnds> search_every_choice(const BandTrials& trials, std::size_t points, double limit_db) {
  const std::size_t n = trials.candidates();
  double choices = 1.0;
  for (std::size_t k = 0; k <= n && choices * static_cast<double>(points) <= kMaxChoices; ++k) {
    const BandTrials::Trial best = trials.best_of_all(k);
    if (best.error_db <= limit_db) return best.inner;
    choices *= static_cast<double>(n - k) / static_cast<double>(k + 1);
  }
  return std::nullopt;
}

}  // namespace

CascadeProblem make_cascade_problem(const BodePoints& points, std::optional<Hertz> base) {
  CascadeProblem out;
  if (points.points.empty()) throw InputError(points.file, 0, "has no points");
  out.base = base.value_or(points.points.front().frequency);
  if (!(out.base.value > 0.0) || !std::isfinite(out.base.value)) {
    throw InputError(fmt::format("the base frequency is {} Hz, expected above 0", out.base.value));
  }
  for (const BodePoint& point : points.points) {
    if (point.frequency == out.base) {
      out.base_gain = point.gain;
    } else if (point.frequency < out.base) {
      out.below.push_back(point.frequency);
    } else {
      out.above.push_back(point);
    }
  }
  if (out.above.empty()) {
    throw InputError(
        points.file, points.points.back().line,
        fmt::format("has no point above the base frequency {} Hz, expected at least one", out.base.value));
  }
  return out;
}

double BandSolution::curve_db(Hertz f) const {
  double np = 0.0;
  for (const FractionalLeadLag& term : terms) np += term.log_magnitude(f.rad_s());
  return kDecibelPerNeper * np;
}

std::vector<FractionalLeadLag> make_bands(Hertz base, const std::vector<BodePoint>& ends) {
  std::vector<FractionalLeadLag> bands;
  Hertz from = base;
  for (const BodePoint& point : ends) {
    bands.push_back({1.0 / from.rad_s().value, from.value / point.frequency.value, 1.0});
    from = point.frequency;
  }
  return bands;
}

BandSolution solve_orders(const CascadeProblem& problem, std::vector<FractionalLeadLag> terms,
                          const std::vector<BodePoint>& above, const CascadeFitOptions& options) {
  if (terms.size() > above.size())
    throw InputError(fmt::format("{} terms for {} points above the base, expected no more terms than points",
                                 terms.size(), above.size()));
  BandSolution out;
  out.terms = std::move(terms);
  for (FractionalLeadLag& term : out.terms) term.beta = 1.0;
  out.matrix = make_matrix(out.terms, above);
  out.bound.assign(out.terms.size(), 0);
  LongVector target;
  for (const BodePoint& point : above)
    target.push_back(std::log(static_cast<long double>(point.gain) / problem.base_gain));
  LongMatrix weighted = out.matrix;
  const bool interpolation = out.terms.size() == above.size() && !options.bounded();
  if (!interpolation) weigh_rows(weighted, target, above);
  LongVector beta;
  if (!options.bounded()) {
    beta = least_squares(weighted, target);
  } else {
    out.upper = options.term_beta_max;
    if (out.upper.empty()) out.upper.assign(out.terms.size(), *options.beta_max);
    if (out.upper.size() != out.terms.size())
      throw InputError(
          fmt::format("{} bounds for {} terms, expected one a term", out.upper.size(), out.terms.size()));
    for (const double bound : out.upper) out.lower.push_back(options.beta_positive ? 0.0 : -bound);
    BoundedSolution solution =
        bounded_least_squares(weighted, target, LongVector(out.lower.begin(), out.lower.end()),
                              LongVector(out.upper.begin(), out.upper.end()));
    beta = std::move(solution.x);
    out.bound = std::move(solution.bound);
    out.optimality_residual = static_cast<double>(solution.optimality_residual);
  }
  for (std::size_t i = 0; i < beta.size(); ++i) out.terms[i].beta = static_cast<double>(beta[i]);
  return out;
}

BandSolution solve_bands(const CascadeProblem& problem, const std::vector<BodePoint>& ends,
                         const std::vector<BodePoint>& above, const CascadeFitOptions& options) {
  return solve_orders(problem, make_bands(problem.base, ends), above, options);
}

BandChoice choose_bands(const CascadeProblem& problem, const CascadeFitOptions& options, double limit_db) {
  const BandTrials trials(problem, options);
  if (const auto inner = search_every_choice(trials, problem.above.size(), limit_db))
    return {trials.ends(*inner), true};
  // Too many to try them all: added where they help most, then taken away again where they do not matter.
  BandTrials::Trial grown = trials.evaluate({});
  while (grown.inner.size() < std::min(trials.candidates(), kMaxBands)) {
    grown = trials.best_with_one_more(grown.inner);
    if (grown.error_db <= limit_db || std::isinf(grown.error_db)) break;
  }
  if (grown.error_db > limit_db) return {trials.ends(grown.inner), false};
  return {trials.ends(trials.without_needless(grown.inner, limit_db)), true};
}

}  // namespace bodesmith
