#include "tracking/lag.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "numeric/fourier.hpp"

namespace bodesmith::tracking {
namespace {

using Complex = std::complex<double>;

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
  const auto found = std::find_if(known.begin(), known.end(), [&x](const Known& one) { return one.x == x; });
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

}  // namespace bodesmith::tracking
