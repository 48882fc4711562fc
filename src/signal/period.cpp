#include "signal/period.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <vector>

#include "base/whole_number.hpp"
#include "numeric/fourier.hpp"
#include "signal/statistics.hpp"

namespace bodesmith {
namespace {

/// Mean squared difference of v and itself p samples later, for every p, from one autocorrelation.
class LagDistance {
 public:
  explicit LagDistance(std::span<const double> v) : n_(v.size()), cumulated_(v.size() + 1, 0.0) {
    const double middle = mean(v);
    std::vector<double> x(std::bit_ceil(2 * n_), 0.0);  // zeros behind, so that the ends do not meet
    for (std::size_t i = 0; i < n_; ++i) {
      x[i] = v[i] - middle;
      cumulated_[i + 1] = cumulated_[i] + x[i] * x[i];
    }
    auto bins = half_spectrum(x);
    for (auto& b : bins) b = std::norm(b);
    correlation_ = from_half_spectrum(bins, x.size());
  }
  double operator()(std::size_t p) const {
    return (cumulated_[n_ - p] + (cumulated_[n_] - cumulated_[p]) - 2.0 * correlation_[p]) /
           static_cast<double>(n_ - p);
  }
  double mean_square() const { return cumulated_[n_] / static_cast<double>(n_); }
  /// First lag below `limit` at which the signal has lost half its likeness to itself.
  std::size_t decorrelation(std::size_t limit) const {
    std::size_t lag = 1;
    while (lag < limit && correlation_[lag] > 0.5 * correlation_[0]) ++lag;
    return lag;
  }

 private:
  std::size_t n_;
  std::vector<double> cumulated_;
  std::vector<double> correlation_;
};

}  // namespace

std::optional<Repetition> find_repetition(std::span<const double> u) {
  if (u.size() < 3) return std::nullopt;
  const auto [low, high] = std::minmax_element(u.begin(), u.end());
  const double close = 1e-9 * (*high - *low);
  if (!(close > 0.0)) return std::nullopt;
  const auto repeats = [&](std::size_t lag) {
    for (std::size_t i = 0; i + lag < u.size(); ++i) {
      if (std::abs(u[i + lag] - u[i]) > close) return false;
    }
    return true;
  };
  // The second period may lack nothing: half the record at most. Signals that stay close to themselves for
  // long would cost the square of their length: enough looking is enough.
  std::size_t looked = 0;
  for (std::size_t lag = 1; 2 * lag <= u.size(); ++lag) {
    if (std::abs(u[lag] - u[0]) > close) continue;
    if (repeats(lag)) return Repetition{lag, 1};
    if (++looked > 2000) break;
  }
  return std::nullopt;
}

std::optional<Repetition> repetition_of(Hertz fundamental, double step_s, std::size_t samples) {
  const double period = 1.0 / (fundamental.value * step_s);
  for (std::size_t cycles = 1; static_cast<double>(cycles) * period < static_cast<double>(samples) + 0.5;
       ++cycles) {
    const double length = static_cast<double>(cycles) * period;
    if (std::abs(length - std::round(length)) > 1e-6) continue;
    const auto whole = whole_number<std::size_t>(std::round(length));
    if (whole >= 2 && whole <= samples) return Repetition{whole, cycles};
  }
  return std::nullopt;
}

std::size_t find_period(std::span<const double> v) {
  constexpr double kAlike = 0.03;
  const std::size_t n = v.size();
  if (n < 16) return 0;
  const LagDistance distance(v);
  const double mean_square = distance.mean_square();
  if (!(mean_square > 0.0)) return 0;
  for (std::size_t p = 8; p <= n / 2; ++p) {
    if (distance(p) > kAlike * kAlike * mean_square) continue;
    // A slow signal is like itself at every small lag: only a minimum beyond the first decorrelation counts.
    const std::size_t leave = distance.decorrelation(p);
    if (p <= 2 * leave) continue;
    // Neighbouring lags may be better still.
    std::size_t best = p;
    for (std::size_t q = p + 1; q <= std::min(n / 2, p + leave); ++q) {
      if (distance(q) < distance(best)) best = q;
    }
    return best;
  }
  return 0;
}

}  // namespace bodesmith
