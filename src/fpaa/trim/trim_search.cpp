#include "fpaa/trim/trim_search.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <utility>

#include "base/whole_number.hpp"
#include "fpaa/device/board.hpp"
#include "numeric/linear_algebra/dense.hpp"
#include "numeric/random.hpp"

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;

/// No capacitor leaves the one that was measured by more than this.
constexpr double kMaxRelativeMove = 0.25;
/// Least squares: price of a relative move of 1, against an error of 1; standard deviation of the random
/// rounding, in units.
constexpr double kMovePrice = 3e-3;
constexpr double kRoundingSpread = 0.3;
constexpr int kRestarts = 12;  ///< of the rounding
constexpr int kMaxSweeps = 60;
/// In exchanges singles are tried up to so many units, pairs by one of these each.
constexpr int kReach = 4;
constexpr int kTrimPairReach = 2;
/// An exchange is worth making from here on.
constexpr double kBetter = 1.0 - 1e-9;

/// Where one capacitor may be: the logarithm of its change and the relative variance of its new units.
struct TrimPlace {
  double log_change = 0.0;
  double variance = 0.0;
};

/// Error and variance at every frequency for one set of capacitors.
struct TrimPrediction {
  std::vector<Complex> error;
  std::vector<double> variance;
};

/// Capacitors that take other units together, and the cost then.
struct Exchange {
  double cost = 0.0;
  std::vector<std::pair<std::size_t, int>> moves;
  void take(double at, std::initializer_list<std::pair<std::size_t, int>> by) {
    if (!(at < cost)) return;
    cost = at;
    moves = by;
  }
};

class TrimSearch {
 public:
  explicit TrimSearch(const TrimProblem& problem) : problem_(problem), units_(problem.units) {
    for (std::size_t c = 0; c < units_.size(); ++c) {
      lowest_.push_back(bound(c, -1));
      places_.emplace_back();
      for (int units = lowest_[c]; units <= bound(c, +1); ++units) places_[c].push_back(place_of(c, units));
      if (places_[c].size() > 1) movable_.push_back(c);
      slope_norm_.emplace_back();
      for (const Complex& s : problem_.slope[c]) slope_norm_[c].push_back(std::norm(s));
    }
  }

  std::vector<int> run() {
    if (movable_.empty()) return units_;
    Random random(problem_.seed);
    double best = 0.0;
    std::vector<int> kept;
    for (int restart = 0; restart <= kRestarts; ++restart) {
      reset(problem_.units);
      // The last time from the capacitors that are there: better where little is to be done.
      if (restart < kRestarts) round_one_after_the_other(restart == 0 ? nullptr : &random);
      const double ended = exchange();
      if (!kept.empty() && ended >= best) continue;
      best = ended;
      kept = units_;
    }
    return kept;
  }

 private:
  int bound(std::size_t c, int side) const {
    const int n = problem_.built[c];
    const int now = problem_.units[c];
    if (n <= 0) return now;
    const int most = static_cast<int>(kMaxRelativeMove * n);
    const int reach = std::max(most > 0 ? 1 : 0, static_cast<int>(problem_.reach * now));
    if (side < 0) return std::min(now, std::max({1, n - most, now - reach}));
    return std::max(now, std::min({kMostUnits, n + most, now + reach}));
  }
  TrimPlace place_of(std::size_t c, int units) const {
    if (units <= 0) return {};
    const auto with = [&](int to) { return problem_.exchanged(problem_.built[c], problem_.excess[c], to); };
    const TrimProblem::Exchanged there = with(units);
    return {std::log(there.units / with(problem_.units[c]).units),
            there.variance / (there.units * there.units)};
  }
  const TrimPlace& place(std::size_t c, int units) const {
    return places_[c][static_cast<std::size_t>(units - lowest_[c])];
  }
  int highest(std::size_t c) const { return lowest_[c] + static_cast<int>(places_[c].size()) - 1; }

  void reset(const std::vector<int>& units) {
    units_ = problem_.units;
    now_ = {problem_.error, std::vector<double>(problem_.error.size(), 0.0)};
    for (std::size_t c = 0; c < units_.size(); ++c) {
      for (std::size_t k = 0; k < now_.error.size(); ++k) {
        now_.variance[k] += place(c, units_[c]).variance * slope_norm_[c][k];
      }
    }
    for (std::size_t c = 0; c < units.size(); ++c) move(c, units[c]);
  }

  void add(std::size_t c, int to, TrimPrediction& out) const {
    const TrimPlace& was = place(c, units_[c]);
    const TrimPlace& is = place(c, to);
    const double by = is.log_change - was.log_change;
    const double more = is.variance - was.variance;
    const std::vector<Complex>& slope = problem_.slope[c];
    for (std::size_t k = 0; k < out.error.size(); ++k) {
      out.error[k] += by * slope[k];
      out.variance[k] += more * slope_norm_[c][k];
    }
  }
  void move(std::size_t c, int to) {
    if (to == units_[c]) return;
    add(c, to, now_);
    units_[c] = to;
  }

  /// The largest error over frequency, and a tenth of the mean, with capacitor c at `to`; infinite where it is above `limit`.
  double cost(const TrimPrediction& from, std::size_t c, int to, double limit) const {
    const TrimPlace& was = place(c, units_[c]);
    const TrimPlace& is = place(c, to);
    const double by = is.log_change - was.log_change;
    const double more = is.variance - was.variance;
    double worst = 0.0;
    double sum = 0.0;
    for (std::size_t k = 0; k < from.error.size(); ++k) {
      const double here =
          std::abs(from.error[k] + by * problem_.slope[c][k]) +
          kCountedDeviations * std::sqrt(std::max(0.0, from.variance[k] + more * slope_norm_[c][k]));
      if (here > limit) return std::numeric_limits<double>::infinity();
      worst = std::max(worst, here);
      sum += here * here;
    }
    return worst + 0.1 * std::sqrt(sum / static_cast<double>(from.error.size()));
  }

  /// The coarsest capacitor first.
  void round_one_after_the_other(Random* random) {
    std::vector<std::size_t> open = movable_;
    std::ranges::stable_sort(
        open, [&](std::size_t a, std::size_t b) { return problem_.units[a] < problem_.units[b]; });
    if (gram_.size() == 0) find_gram(open);
    for (std::size_t first = 0; first < open.size(); ++first) {
      const std::size_t c = open[first];
      const double spread = random != nullptr ? kRoundingSpread * random->normal() : 0.0;
      const double wanted = units_[c] * std::exp(real_move(open, first)) + spread;
      move(c, nearest_whole<int>(
                  std::clamp(wanted, static_cast<double>(lowest_[c]), static_cast<double>(highest(c)))));
    }
  }

  void find_gram(const std::vector<std::size_t>& order) {
    const auto count = static_cast<Eigen::Index>(order.size());
    gram_ = Eigen::MatrixXd::Zero(count, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      for (Eigen::Index j = 0; j <= i; ++j) {
        gram_(i, j) = gram_(j, i) = product(problem_.slope[order[static_cast<std::size_t>(i)]],
                                            problem_.slope[order[static_cast<std::size_t>(j)]]);
      }
      gram_(i, i) += kMovePrice * kMovePrice * static_cast<double>(problem_.error.size());
    }
  }
  static double product(const std::vector<Complex>& a, const std::vector<Complex>& b) {
    double out = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) out += a[k].real() * b[k].real() + a[k].imag() * b[k].imag();
    return out;
  }
  /// Of capacitor order[first] when all from there on may be any number: ln of its change.
  double real_move(const std::vector<std::size_t>& order, std::size_t first) const {
    const auto count = static_cast<Eigen::Index>(order.size() - first);
    Eigen::VectorXd b(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      b(i) = -product(problem_.slope[order[first + static_cast<std::size_t>(i)]], now_.error);
    }
    return solve_ldlt(gram_.bottomRightCorner(count, count), b)(0);
  }

  /// The cost that no exchange of one or two capacitors betters.
  double exchange() {
    const std::size_t any = movable_.front();
    double now = cost(now_, any, units_[any], std::numeric_limits<double>::infinity());
    for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
      Exchange best{now * kBetter, {}};
      for (const std::size_t c : movable_)
        each_place(c, kReach, [&](int to) { best.take(cost(now_, c, to, best.cost), {{c, to}}); });
      if (best.moves.empty()) best_pair(best);
      if (best.moves.empty()) break;
      for (const auto& [c, to] : best.moves) move(c, to);
      now = best.cost;
    }
    return now;
  }

  void best_pair(Exchange& best) const {
    for (std::size_t i = 0; i < movable_.size(); ++i) {
      const std::size_t a = movable_[i];
      each_place(a, kTrimPairReach, [&](int to_a) {
        TrimPrediction one = now_;
        add(a, to_a, one);
        for (std::size_t j = i + 1; j < movable_.size(); ++j) {
          const std::size_t b = movable_[j];
          each_place(b, kTrimPairReach, [&](int to_b) {
            best.take(cost(one, b, to_b, best.cost), {{a, to_a}, {b, to_b}});
          });
        }
      });
    }
  }

  /// Calls with every other number of units within reach of a capacitor's.
  template <typename Call>
  void each_place(std::size_t c, int reach, const Call& call) const {
    for (int to = std::max(lowest_[c], units_[c] - reach); to <= std::min(highest(c), units_[c] + reach);
         ++to)
      if (to != units_[c]) call(to);
  }

  const TrimProblem& problem_;
  std::vector<int> units_;
  std::vector<int> lowest_;
  std::vector<std::vector<TrimPlace>> places_;  ///< of each capacitor, from lowest_ on
  std::vector<std::vector<double>> slope_norm_;
  std::vector<std::size_t> movable_;
  Eigen::MatrixXd gram_;  ///< of the slopes, coarsest capacitor first, with the price of moves
  TrimPrediction now_;
};

}  // namespace

TrimProblem::Exchanged TrimProblem::exchanged(int from, double more, int to) const {
  if (to <= 0) return {};
  const ExchangedUnits x = exchanged_units(from, to, array, unit_variance);
  return {to + more * x.kept + systematic_units, x.variance};
}

std::vector<int> search_trim(const TrimProblem& problem) {
  return TrimSearch(problem).run();
}

}  // namespace bodesmith::fpaa
