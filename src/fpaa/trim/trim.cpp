#include "fpaa/trim/trim.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/whole_number.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/plan/switched_board.hpp"
#include "fpaa/trim/trim_search.hpp"
#include "numeric/linear_algebra/dense.hpp"
#include "numeric/random.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::fpaa {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kTrimPoints = 48;
constexpr double kUnrelatedFactor = 2.0;
/// Range in which a measurement's own deviation is looked for.
constexpr double kLeastNoise = 1e-6;
constexpr double kMostNoise = 0.3;
constexpr int kTrimNoisePoints = 61;
constexpr double kLeastSigma = 1e-9;  ///< of a capacitor: a model of 0 % is not singular

VectorXd prior_deviation(const DrawnBoard& board, const MismatchModel& mismatch) {
  const auto& units = board.nominal_units();
  VectorXd out(static_cast<Index>(units.size()));
  for (std::size_t c = 0; c < units.size(); ++c) {
    out(static_cast<Index>(c)) = std::max(kLeastSigma, mismatch.relative_sigma(units[c]));
  }
  return out;
}

/// ln of measured over the board with these capacitors: magnitudes, then phases where they were measured.
VectorXd log_difference(const DrawnBoard& board, const std::vector<double>& units,
                        const MeasuredBoard& measured) {
  const std::vector<Complex> h = board.response(units);
  const auto points = static_cast<Index>(h.size());
  VectorXd out(measured.phase_rad.empty() ? points : 2 * points);
  for (Index k = 0; k < points; ++k) {
    const auto at = static_cast<std::size_t>(k);
    out(k) = std::log(measured.gain[at] / std::abs(h[at]));
    if (measured.phase_rad.empty()) continue;
    out(points + k) = std::arg(std::polar(1.0, measured.phase_rad[at]) / h[at]);
  }
  return out;
}

MatrixXd log_slopes(const DrawnBoard& board, const std::vector<double>& units, bool with_phase) {
  const auto slopes = board.sensitivities(units);
  const auto points = static_cast<Index>(board.grid().size());
  MatrixXd out(with_phase ? 2 * points : points, static_cast<Index>(slopes.size()));
  for (Index c = 0; c < out.cols(); ++c) {
    for (Index k = 0; k < points; ++k) {
      const Complex slope = slopes[static_cast<std::size_t>(c)][static_cast<std::size_t>(k)];
      out(k, c) = slope.real();
      if (with_phase) out(points + k, c) = slope.imag();
    }
  }
  return out;
}

/// The deviation of the measurement under which it is most likely: y is normal with covariance
/// A A' + s^2 1, A = S times the prior's deviations.
double likeliest_noise(const MatrixXd& a, const VectorXd& y) {
  const SymmetricEigen eigen = symmetric_eigen(gram(a.transpose()));
  const VectorXd along = transpose_times(eigen.vectors, y);
  double best = kLeastNoise;
  double best_score = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < kTrimNoisePoints; ++i) {
    const double s = kLeastNoise * std::pow(kMostNoise / kLeastNoise, i / (kTrimNoisePoints - 1.0));
    double score = 0.0;
    for (Index k = 0; k < along.size(); ++k) {
      const double variance = std::max(0.0, eigen.values(k)) + s * s;
      score -= 0.5 * (std::log(variance) + along(k) * along(k) / variance);
    }
    if (score > best_score) {
      best_score = score;
      best = s;
    }
  }
  return best;
}

void check_related(const VectorXd& y, Index points) {
  const double off = y.head(points).cwiseAbs().maxCoeff();
  if (off <= std::log(kUnrelatedFactor)) return;
  throw DesignError(fmt::format(
      "the measured response is a factor of {:.3g} away from the plan's, expected a measurement of "
      "this board (within a factor of {})",
      std::exp(off), kUnrelatedFactor));
}

/// A capacitor with a relative error (ln); one that is not there stays so.
double with_error(double units, double x, const MismatchModel& mismatch) {
  return units > 0.0 ? units * std::exp(x) + mismatch.systematic_units : 0.0;
}

std::vector<double> with_errors(const std::vector<double>& units, const MismatchModel& mismatch,
                                const VectorXd& x) {
  std::vector<double> out(units);
  for (std::size_t c = 0; c < out.size(); ++c) {
    out[c] = with_error(out[c], x(static_cast<Index>(c)), mismatch);
  }
  return out;
}

/// New capacitors of a board of which something is known.
class TrimDesign {
 public:
  TrimDesign(const DrawnBoard& board, const std::vector<Complex>& wanted, const BoardEstimate& estimate,
             const TrimOptions& options)
      : board_(board), wanted_(wanted), estimate_(estimate), options_(options) {
    const std::vector<double>& built = board_.nominal_units();
    problem_.unit_variance = std::pow(options.mismatch.unit_percent / 100.0, 2);
    problem_.systematic_units = options.mismatch.systematic_units;
    problem_.array = options.array;
    problem_.seed = options.seed;
    for (std::size_t c = 0; c < built.size(); ++c) {
      problem_.built.push_back(nearest_whole<int>(built[c]));
      problem_.excess.push_back(built[c] * std::expm1(estimate.error[c]));
    }
    problem_.units = problem_.built;
  }

  /// Searches whole capacitors, linearised three times, nearer and nearer to what was found.
  std::vector<int> best() {
    std::vector<int> best = problem_.built;
    double least = linearise();
    for (const double reach : {0.25, 0.04, 0.02}) {
      problem_.reach = reach;
      problem_.units = search_trim(problem_);
      const double worst = linearise();
      if (worst >= least) continue;
      least = worst;
      best = problem_.units;
    }
    return best;
  }

  /// Whether these are better than the old ones on every board that agrees with the measurement; fills both errors.
  bool proves(const std::vector<int>& units, TrimError& before, TrimError& after) const {
    Random random(options_.seed);
    const std::vector<double>& old = board_.nominal_units();
    std::vector<double> old_percent, new_percent;
    bool better = true;
    std::vector<double> real(old.size());
    for (int sample = 0; sample < options_.samples; ++sample) {
      const std::vector<double> x = drawn_errors(random);
      for (std::size_t c = 0; c < real.size(); ++c) {
        real[c] = with_error(old[c], x[c], options_.mismatch);
      }
      const ResponseDifference was = compare_responses(board_.grid(), board_.response(real), wanted_);
      for (std::size_t c = 0; c < real.size(); ++c) {
        const double number = random.normal();
        const auto moved = problem_.exchanged(problem_.built[c], old[c] * std::expm1(x[c]), units[c]);
        real[c] = moved.units + std::sqrt(moved.variance) * number;
      }
      const ResponseDifference is = compare_responses(board_.grid(), board_.response(real), wanted_);
      better = better && is.max_complex_percent < was.max_complex_percent &&
               is.max_magnitude_db <= was.max_magnitude_db;
      old_percent.push_back(was.max_complex_percent);
      new_percent.push_back(is.max_complex_percent);
    }
    before = {quantile(old_percent, 0.5), quantile(old_percent, 0.95)};
    after = {quantile(new_percent, 0.5), quantile(new_percent, 0.95)};
    return better;
  }

 private:
  std::vector<double> drawn_errors(Random& random) const {
    std::vector<double> out = estimate_.error;
    std::vector<double> numbers;
    for (std::size_t c = 0; c < out.size(); ++c) numbers.push_back(random.normal());
    for (std::size_t c = 0; c < out.size(); ++c) {
      for (std::size_t k = 0; k < numbers.size(); ++k) out[c] += estimate_.root[c][k] * numbers[k];
    }
    return out;
  }

  /// Error and slopes at problem_.units, not linear; the worst error expected there.
  double linearise() {
    std::vector<double> real, variances;
    for (std::size_t c = 0; c < problem_.units.size(); ++c) {
      const auto [units, variance] =
          problem_.exchanged(problem_.built[c], problem_.excess[c], problem_.units[c]);
      real.push_back(units);
      variances.push_back(variance);
    }
    const std::vector<Complex> got = board_.response(real);
    problem_.slope = board_.sensitivities(real);
    problem_.error.clear();
    double worst = 0.0;
    for (std::size_t k = 0; k < got.size(); ++k) {
      const Complex ratio = got[k] / wanted_[k];
      problem_.error.push_back(ratio - 1.0);
      double variance = 0.0;
      for (std::size_t c = 0; c < real.size(); ++c) {
        problem_.slope[c][k] *= ratio;
        if (problem_.units[c] == 0) continue;
        variance += variances[c] / (real[c] * real[c]) * std::norm(problem_.slope[c][k]);
      }
      worst = std::max(worst, std::abs(ratio - 1.0) + kCountedDeviations * std::sqrt(variance));
    }
    return worst;
  }

  const DrawnBoard& board_;
  const std::vector<Complex>& wanted_;
  const BoardEstimate& estimate_;
  const TrimOptions& options_;
  TrimProblem problem_;
};

}  // namespace

BoardEstimate estimate_board(const Plan& plan, const MeasuredBoard& measured, const MismatchModel& mismatch) {
  constexpr int kLinearisations = 3;
  const DrawnBoard board(plan, measured.grid);
  const bool with_phase = !measured.phase_rad.empty();
  const VectorXd prior = prior_deviation(board, mismatch);
  const auto count = prior.size();
  VectorXd x = VectorXd::Zero(count);
  MatrixXd factor;
  BoardEstimate out;
  for (int pass = 0; pass < kLinearisations; ++pass) {
    const std::vector<double> units = with_errors(board.nominal_units(), mismatch, x);
    const MatrixXd slopes = log_slopes(board, units, with_phase);
    const VectorXd difference = log_difference(board, units, measured);
    if (pass == 0) check_related(difference, static_cast<Index>(measured.grid.size()));
    // In units of the prior's deviations: y = A u + noise, u standard normal.
    const VectorXd y = difference + times(slopes, x);
    const MatrixXd a = slopes * prior.asDiagonal();
    out.noise = measured.deviation.value_or(likeliest_noise(a, y));
    const double weight = 1.0 / std::pow(std::max(out.noise, kLeastNoise), 2);
    const MatrixXd precision = MatrixXd::Identity(count, count) + weight * gram(a);
    // P = D precision^-1 D: D L'^-1 is a root of it.
    const MatrixXd inverted = solve_lower(cholesky_factor(precision), MatrixXd::Identity(count, count));
    factor = prior.asDiagonal() * inverted.transpose();
    x = weight * times(factor, times(inverted, transpose_times(a, y)));
  }
  for (Index c = 0; c < count; ++c) {
    out.error.push_back(x(c));
    out.root.emplace_back(factor.row(c).begin(), factor.row(c).end());
  }
  return out;
}

std::vector<Hertz> trim_grid(const Plan& plan, const TrimOptions& options) {
  return log_grid(options.band.value_or(plan.error.band), kTrimPoints);
}

Plan with_capacitors(const Plan& plan, const std::vector<int>& units) {
  Plan out = plan;
  std::size_t next = 0;
  for (ChipPlan& chip : out.chips) {
    for (PlacedCam& cam : chip.cams) {
      for (Capacitor& c : cam.capacitors) c.units = units.at(next++);
      cam.find_z();
    }
  }
  return out;
}

namespace {

/// What a plan says of itself, of its new capacitors. What 95 % of boards keep is no question of one board.
void restate(Plan& plan, const std::vector<Hertz>& grid, const std::vector<Complex>& wanted) {
  const SwitchedBoard board(plan);
  std::vector<Complex> running, sampled;
  for (const Hertz f : grid) {
    running.push_back(board.gain(f.rad_s()));
    sampled.push_back(board.sampled(f.rad_s()));
  }
  const Band band{grid.front(), grid.back()};
  plan.error = {compare_responses(grid, sampled, wanted), band};
  plan.error_with_delays = {compare_responses(grid, running, wanted), band};
  plan.total.reset();
  plan.trade_off.clear();
  const std::string note =
      "trimmed for one measured board, of which trim.json says what is expected; errors here are of nominal capacitors, images "
      "and headroom those of the plan before";
  if (std::ranges::find(plan.notes, note) == plan.notes.end()) plan.notes.push_back(note);
}

}  // namespace

Trim trim_board(const Plan& plan, const std::vector<Complex>& wanted, const std::vector<Hertz>& grid,
                const MeasuredBoard& measured, const TrimOptions& options) {
  Trim out;
  out.array = options.array;
  out.estimate = estimate_board(plan, measured, options.mismatch);
  const DrawnBoard board(plan, grid);
  TrimDesign design(board, wanted, out.estimate, options);
  const std::vector<int> units = design.best();
  out.improved = design.proves(units, out.before, out.after);
  if (!out.improved) {
    out.plan = plan;
    out.after = out.before;
    return out;
  }
  out.plan = with_capacitors(plan, units);
  restate(out.plan, grid, wanted);
  for (std::size_t c = 0; c < units.size(); ++c) {
    const int old = nearest_whole<int>(board.nominal_units()[c]);
    if (old != units[c]) out.changes.push_back({board.names()[c], old, units[c]});
  }
  return out;
}

Json Trim::to_json() const {
  const auto error = [](const TrimError& e) {
    return Json{{"median_percent", e.median_percent}, {"p95_percent", e.p95_percent}};
  };
  Json out{{"improved", improved},
           {"unit_array", to_string(array)},
           {"before", error(before)},
           {"after", error(after)},
           {"measurement_deviation_percent", 100.0 * estimate.noise},
           {"changes", Json::array()}};
  for (const TrimmedCapacitor& c : changes) {
    out["changes"].push_back({{"capacitor", c.name}, {"before", c.before}, {"after", c.after}});
  }
  return out;
}

}  // namespace bodesmith::fpaa
