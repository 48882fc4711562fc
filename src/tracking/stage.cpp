#include "tracking/stage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "base/error.hpp"
#include "hysteresis/polynomial_disturbance.hpp"
#include "numeric/fourier.hpp"
#include "tracking/settled_path.hpp"

namespace bodesmith::tracking {
namespace {

/// The correlation of y with the delayed x and its derivatives by the delay.
struct Correlation {
  double value = 0.0;
  double slope = 0.0;
  double curvature = 0.0;
};

/// Spectra of references, of which a study has few that come again and again: the last ones are kept, one row a thread.
const std::vector<Complex>& reference_spectrum(const std::vector<double>& x) {
  constexpr std::size_t kKept = 8, kLongest = std::size_t{1} << 17;
  struct Known {
    std::vector<double> x;
    std::vector<Complex> spectrum;
  };
  thread_local std::array<Known, kKept> known;
  thread_local std::size_t next = 0;
  thread_local std::vector<Complex> long_one;
  if (x.size() > kLongest) return long_one = half_spectrum(x);
  const auto found = std::ranges::find(known, x, &Known::x);
  if (found != known.end()) return found->spectrum;
  Known& place = known[next++ % kKept];
  place = {x, half_spectrum(x)};
  return place.spectrum;
}

/// A short cosine series: the cross spectrum up to its last term that counts.
class CrossSpectrum {
 public:
  /// Both spectra up to the middle bin of n samples.
  CrossSpectrum(const std::vector<Complex>& y_hat, const std::vector<Complex>& x_hat, std::size_t n,
                double period_s)
      : period_s_(period_s) {
    const double scale = 1.0 / (static_cast<double>(n) * static_cast<double>(n));
    std::size_t last = 0;
    double max = 0.0;  // squared
    terms_.resize(n / 2 + 1);
    for (std::size_t k = 0; k <= n / 2; ++k) {
      terms_[k] = y_hat[k] * std::conj(x_hat[k]) * scale * (k == 0 || 2 * k == n ? 1.0 : 2.0);
      const double size = std::norm(terms_[k]);
      max = std::max(max, size);
      if (size > 1e-30 * max) last = k;
    }
    terms_.resize(last + 1);
  }

  Correlation at(double lag) const {
    Correlation out;
    const Complex step = std::polar(1.0, 2.0 * std::numbers::pi * lag / period_s_);
    Complex turn = 1.0;
    for (std::size_t k = 0; k < terms_.size(); ++k) {
      const double w = 2.0 * std::numbers::pi * static_cast<double>(k) / period_s_;
      const Complex part = terms_[k] * turn;
      out.value += part.real();
      out.slope -= w * part.imag();
      out.curvature -= w * w * part.real();
      turn *= step;
    }
    return out;
  }
  /// By the strongest line alone: the fundamental, unless the signals repeat several times.
  double first_guess() const {
    std::size_t strongest = 1;
    for (std::size_t k = 1; k < terms_.size(); ++k)
      if (std::norm(terms_[k]) > std::norm(terms_[strongest])) strongest = k;
    if (strongest >= terms_.size()) return 0.0;
    return -std::arg(terms_[strongest]) / (2.0 * std::numbers::pi * static_cast<double>(strongest)) *
           period_s_;
  }

 private:
  double period_s_;
  std::vector<Complex> terms_;
};

/// Newton's method from the fundamental's phase, which is close enough.
double lag_of_largest(const CrossSpectrum& cross, double period_s) {
  double lag = cross.first_guess();
  Correlation best = cross.at(lag);
  for (int i = 0; i < 30; ++i) {
    if (!(best.curvature < 0.0)) break;
    const double next = lag - best.slope / best.curvature;
    const Correlation got = cross.at(next);
    if (!(got.value >= best.value - 1e-18)) break;
    const bool done = std::abs(next - lag) <= 1e-13 * period_s;
    lag = next;
    best = got;
    if (done) break;
  }
  return lag;
}

using Branch = Disturbance::Branch;

/// Where a repeating signal turns; a maximum and a minimum by turns.
struct TurningPoint {
  std::size_t at = 0;
  bool maximum = false;
};

/// The turning points of one round, from the global minimum on (index 0 of the rotated signal).
std::vector<TurningPoint> turning_points(std::span<const double> u, std::size_t start, double turn_back) {
  const std::size_t n = u.size();
  std::vector<TurningPoint> out = {{start, false}};
  std::size_t extreme = start;
  bool rising = true;  // from the global minimum it can only rise
  for (std::size_t k = start + 1;; ++k) {
    if (k == n) k = 0;
    if (k == start) break;
    const double ahead = rising ? u[k] - u[extreme] : u[extreme] - u[k];
    if (ahead > 0.0) extreme = k;
    if (-ahead > turn_back) {
      out.push_back({extreme, rising});
      rising = !rising;
      extreme = k;
    }
  }
  // The round ends falling to the minimum it began with; a last rise that is not over is none.
  if (rising && out.size() > 1) out.pop_back();
  return out;
}

}  // namespace

LagResult best_lag(const std::vector<double>& y, const std::vector<double>& x, double period_s) {
  const std::size_t n = y.size();
  const std::vector<Complex> y_hat = half_spectrum(y);
  const std::vector<Complex>& x_hat = reference_spectrum(x);
  // The mean square of y - x(t - lag) is constants minus twice the correlation.
  LagResult out;
  out.lag_s = lag_of_largest(CrossSpectrum(y_hat, x_hat, n, period_s), period_s);
  // Straight from the difference: the constants nearly cancel. Bins beyond the middle are conjugates.
  const double scale = 1.0 / (static_cast<double>(n) * static_cast<double>(n));
  const Complex step = std::polar(1.0, -2.0 * std::numbers::pi * out.lag_s / period_s);
  Complex turn = 1.0;
  double mean_square = 0.0;
  for (std::size_t k = 0; k < y_hat.size(); ++k, turn *= step)
    mean_square += std::norm(y_hat[k] - x_hat[k] * turn) * scale * (k == 0 || 2 * k == n ? 1.0 : 2.0);
  out.rms = std::sqrt(mean_square);
  return out;
}

void check_drive(std::span<const double> v) {
  if (v.empty()) throw InputError("the drive has no samples");
  if (!std::ranges::all_of(v, [](double value) { return std::isfinite(value); }))
    throw InputError("the drive has a sample that is no number");
}

PolynomialStage::PolynomialStage(Disturbance disturbance, StagePaths paths)
    : PolynomialStage(std::move(disturbance), std::move(paths), Options{}) {}

PolynomialStage::PolynomialStage(Disturbance disturbance, StagePaths paths, Options options)
    : disturbance_(std::move(disturbance)), paths_(std::move(paths)), options_(options) {
  if (!(options_.alpha > 0.0)) throw InputError("the amplitude alpha of the stage is not above 0");
}

std::vector<double> PolynomialStage::response(std::span<const double> v, double step_s, Hertz operating,
                                              DriveKind kind) const {
  check_drive(v);
  const std::vector<double> u = through_path(paths_.drive, v, step_s);
  const std::vector<double> q =
      options_.rule == Rule::nested ? by_turning_points(u, operating) : by_slope(u, operating, kind);
  return through_path(paths_.mechanics, q, step_s);
}

std::vector<double> PolynomialStage::by_slope(const std::vector<double>& u, Hertz operating,
                                              DriveKind kind) const {
  const double alpha = options_.alpha;
  double gain[2];
  for (const Branch branch : kBranches) {
    gain[branch_index(branch)] =
        disturbance_.rate_gain(branch, operating) * disturbance_.amplitude.at(branch, alpha);
  }
  const std::vector<bool> rising = rising_samples(u, alpha, kind);
  std::vector<double> q(u.size());
  for (std::size_t i = 0; i < u.size(); ++i) {
    const Branch branch = branch_of(rising[i]);
    q[i] = u[i] + gain[rising[i] ? 0 : 1] * disturbance_.value(branch, u[i] / alpha);
  }
  return q;
}

std::vector<double> PolynomialStage::by_turning_points(const std::vector<double>& u, Hertz operating) const {
  hysteresis::PolynomialDisturbance model;
  model.ascending.polynomial = disturbance_.ascending;
  model.descending.polynomial = disturbance_.descending;
  model.nested = true;
  model.strokes = disturbance_.amplitude;
  model.rate_gain_ascending = disturbance_.rate_gain(Branch::ascending, operating);
  model.rate_gain_descending = disturbance_.rate_gain(Branch::descending, operating);
  hysteresis::PolynomialOperator stage(std::move(model));
  std::vector<double> q(u.size());
  stage.reset(u[0]);
  // Turning points repeat after one round: the second one is settled.
  for (int round = 0; round < 2; ++round) {
    for (std::size_t i = 0; i < u.size(); ++i) q[i] = stage.step(u[i], 0.0);
  }
  return q;
}

std::vector<double> through_path(const Sections& path, std::span<const double> u, double step_s) {
  return settled_path(state_space(path), u, step_s).output;
}

std::vector<bool> rising_samples(std::span<const double> u, double alpha, DriveKind kind) {
  const std::size_t n = u.size();
  const auto start = static_cast<std::size_t>(std::ranges::min_element(u) - u.begin());
  const std::vector<TurningPoint> turns =
      turning_points(u, start, (kind == DriveKind::smooth ? 1e-5 : 0.02) * alpha);
  std::vector<bool> out(n, true);
  if (turns.size() == 1) return out;  // it never turns
  for (std::size_t t = 0; t < turns.size(); ++t) {
    const std::size_t end = t + 1 < turns.size() ? turns[t + 1].at : start;
    for (std::size_t k = turns[t].at; turns[t].maximum && k != end; k = k + 1 == n ? 0 : k + 1)
      out[k] = false;
  }
  // Where the drive jumps from branch to branch, the turning sample belongs to the side that it is close to. A jump through a lag
  // far shorter than a sample has its extreme one or two samples later (between samples it counts as a ramp): a step four times
  // the one before it, which leaves less than a quarter of itself to go, has arrived.
  const auto step_to = [&](std::size_t k) { return std::abs(u[k % n] - u[(k + n - 1) % n]); };
  for (const TurningPoint& turn : turns) {
    const bool up = !turn.maximum;
    if (step_to(turn.at + 1) > step_to(turn.at)) out[turn.at] = !up;
    for (std::size_t back = 1; back <= 2; ++back) {
      const std::size_t k = (turn.at + n - back) % n;
      if (step_to(k) <= 4.0 * step_to(k + n - 1) || std::abs(u[turn.at] - u[k]) >= 0.25 * step_to(k))
        continue;
      for (std::size_t i = 0; i <= back; ++i) out[(k + i) % n] = up;
    }
  }
  return out;
}

TrackingError plain_error(std::span<const double> y, std::span<const double> x) {
  if (x.empty() || y.empty() || y.size() % x.size() != 0) {
    throw InputError(fmt::format(
        "a displacement of {} samples over a reference of {}, expected whole periods", y.size(), x.size()));
  }
  const auto [low, high] = std::minmax_element(y.begin(), y.end());
  TrackingError out;
  out.range = *high - *low;
  if (!(out.range > 0.0)) throw InputError("the stage does not move");
  double sum = 0.0;
  double max = 0.0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    const double e = y[i] - x[i % x.size()];
    sum += e * e;
    max = std::max(max, std::abs(e));
  }
  out.rms_percent = 100.0 * std::sqrt(sum / static_cast<double>(y.size())) / out.range;
  out.max_percent = 100.0 * max / out.range;
  return out;
}

TrackingError tracking_error(std::span<const double> y, std::span<const double> x, double period_s) {
  TrackingError out = plain_error(y, x);
  std::vector<double> wanted;
  wanted.reserve(y.size());
  while (wanted.size() < y.size()) wanted.insert(wanted.end(), x.begin(), x.end());
  const auto periods = static_cast<double>(y.size() / x.size());
  const LagResult lag = best_lag({y.begin(), y.end()}, wanted, periods * period_s);
  out.lag_s = lag.lag_s;
  out.rms_percent_without_lag = 100.0 * lag.rms / out.range;
  return out;
}

}  // namespace bodesmith::tracking
