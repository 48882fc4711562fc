#include "fpaa/trim_search.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;

/// No capacitor leaves its old value by more than this: the prediction is linear, and a small capacitor in
/// quite another size is another capacitor.
constexpr double kMaxRelativeMove = 0.12;
constexpr int kMaxSteps = 400;
/// Singles are tried up to so many units, pairs by one of these each.
constexpr int kReach = 4;
constexpr int kTrimPairReach = 2;
/// Standard deviations of what exchanged units add that count as error.
constexpr double kCounted = 2.0;

class TrimSearch {
 public:
  explicit TrimSearch(const TrimProblem& problem) : problem_(problem), units_(problem.units) {
    error_ = problem.error;
    variance_.assign(error_.size(), 0.0);
    for (std::size_t c = 0; c < units_.size(); ++c) {
      if (lowest(c) < highest(c)) movable_.push_back(c);
    }
  }

  std::vector<int> run() {
    round_one_after_the_other();
    exchange();
    const double rounded = cost(error_, variance_);
    const std::vector<int> kept = units_;
    // From the old capacitors on, without the real solution: better where little is to be done.
    reset();
    exchange();
    if (rounded < cost(error_, variance_)) {
      reset();
      for (std::size_t c = 0; c < kept.size(); ++c) move(c, kept[c]);
    }
    return units_;
  }

 private:
  int lowest(std::size_t c) const {
    const int n = problem_.units[c];
    return std::max(1, n - static_cast<int>(kMaxRelativeMove * n));
  }
  int highest(std::size_t c) const {
    const int n = problem_.units[c];
    return std::min(problem_.max_units, n + static_cast<int>(kMaxRelativeMove * n));
  }
  double log_of(std::size_t c, int units) const {
    return std::log(static_cast<double>(units) / problem_.units[c]);
  }
  /// Variance of a capacitor's relative error that its exchanged units add.
  double added_variance(std::size_t c, int units) const {
    return problem_.unit_variance * std::abs(units - problem_.units[c]) /
           (static_cast<double>(units) * units);
  }

  static double cost_at(const Complex& error, double variance) {
    return std::abs(error) + kCounted * std::sqrt(variance);
  }
  static double cost(const std::vector<Complex>& error, const std::vector<double>& variance) {
    double worst = 0.0;
    double sum = 0.0;
    for (std::size_t k = 0; k < error.size(); ++k) {
      const double here = cost_at(error[k], variance[k]);
      worst = std::max(worst, here);
      sum += here * here;
    }
    return worst + 0.1 * std::sqrt(sum / static_cast<double>(error.size()));
  }

  void reset() {
    units_ = problem_.units;
    error_ = problem_.error;
    std::fill(variance_.begin(), variance_.end(), 0.0);
  }

  /// Moves one capacitor in the running sums.
  void add(std::size_t c, int to, std::vector<Complex>& error, std::vector<double>& variance) const {
    const double by = log_of(c, to) - log_of(c, units_[c]);
    const double more = added_variance(c, to) - added_variance(c, units_[c]);
    for (std::size_t k = 0; k < error.size(); ++k) {
      error[k] += by * problem_.slope[c][k];
      variance[k] = std::max(0.0, variance[k] + more * std::norm(problem_.slope[c][k]));
    }
  }
  void move(std::size_t c, int to) {
    add(c, to, error_, variance_);
    units_[c] = to;
  }

  /// Real least squares over the capacitors that are still free, with a price that grows as they leave their
  /// old value; the coarsest is rounded, the others solved again.
  void round_one_after_the_other() {
    std::vector<std::size_t> open = movable_;
    std::sort(open.begin(), open.end(),
              [&](std::size_t a, std::size_t b) { return problem_.units[a] < problem_.units[b]; });
    while (!open.empty()) {
      const Eigen::VectorXd wanted = real_solution(open);
      const std::size_t c = open.front();
      const double units = problem_.units[c] * std::exp(log_of(c, units_[c]) + wanted(0));
      move(c, std::clamp(static_cast<int>(std::lround(units)), lowest(c), highest(c)));
      open.erase(open.begin());
    }
  }

  Eigen::VectorXd real_solution(const std::vector<std::size_t>& open) const {
    constexpr double kPrice = 1e-3;  // of a relative move of 1, against an error of 1
    const auto count = static_cast<Eigen::Index>(open.size());
    const auto points = static_cast<Eigen::Index>(error_.size());
    Eigen::MatrixXd s(2 * points, count);
    Eigen::VectorXd e(2 * points);
    for (Eigen::Index k = 0; k < points; ++k) {
      const auto at = static_cast<std::size_t>(k);
      e(2 * k) = error_[at].real();
      e(2 * k + 1) = error_[at].imag();
      for (Eigen::Index i = 0; i < count; ++i) {
        const Complex slope = problem_.slope[open[static_cast<std::size_t>(i)]][at];
        s(2 * k, i) = slope.real();
        s(2 * k + 1, i) = slope.imag();
      }
    }
    Eigen::MatrixXd gram = s.transpose() * s;
    gram.diagonal().array() += kPrice * kPrice * static_cast<double>(points);
    return gram.ldlt().solve(-s.transpose() * e);
  }

  void exchange() {
    double now = cost(error_, variance_);
    for (int step = 0; step < kMaxSteps; ++step) {
      const double single = best_single(now);
      if (single < now) {
        now = single;
        continue;
      }
      const double pair = best_pair(now);
      if (!(pair < now)) return;
      now = pair;
    }
  }

  double best_single(double now) {
    double best = now;
    std::size_t which = 0;
    int to_units = 0;
    std::vector<Complex> error;
    std::vector<double> variance;
    for (const std::size_t c : movable_) {
      for (int to = units_[c] - kReach; to <= units_[c] + kReach; ++to) {
        if (to == units_[c] || to < lowest(c) || to > highest(c)) continue;
        error = error_;
        variance = variance_;
        add(c, to, error, variance);
        const double here = cost(error, variance);
        if (here < best * (1.0 - 1e-9)) {
          best = here;
          which = c;
          to_units = to;
        }
      }
    }
    if (best < now) move(which, to_units);
    return best;
  }

  double best_pair(double now) {
    double best = now;
    std::pair<std::size_t, int> first{0, 0};
    std::pair<std::size_t, int> second{0, 0};
    std::vector<Complex> one, both;
    std::vector<double> one_variance, both_variance;
    for (std::size_t i = 0; i < movable_.size(); ++i) {
      const std::size_t a = movable_[i];
      for (int to_a = units_[a] - kTrimPairReach; to_a <= units_[a] + kTrimPairReach; ++to_a) {
        if (to_a == units_[a] || to_a < lowest(a) || to_a > highest(a)) continue;
        one = error_;
        one_variance = variance_;
        add(a, to_a, one, one_variance);
        for (std::size_t j = i + 1; j < movable_.size(); ++j) {
          const std::size_t b = movable_[j];
          for (int to_b = units_[b] - kTrimPairReach; to_b <= units_[b] + kTrimPairReach; ++to_b) {
            if (to_b == units_[b] || to_b < lowest(b) || to_b > highest(b)) continue;
            both = one;
            both_variance = one_variance;
            add(b, to_b, both, both_variance);
            const double here = cost(both, both_variance);
            if (here < best * (1.0 - 1e-9)) {
              best = here;
              first = {a, to_a};
              second = {b, to_b};
            }
          }
        }
      }
    }
    if (best < now) {
      move(first.first, first.second);
      move(second.first, second.second);
    }
    return best;
  }

  const TrimProblem& problem_;
  std::vector<int> units_;
  std::vector<Complex> error_;
  std::vector<double> variance_;
  std::vector<std::size_t> movable_;
};

}  // namespace

std::vector<int> search_trim(const TrimProblem& problem) {
  return TrimSearch(problem).run();
}

}  // namespace bodesmith::fpaa
