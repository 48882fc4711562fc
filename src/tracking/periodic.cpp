#include "tracking/periodic.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "numeric/fourier.hpp"

namespace bodesmith::tracking {
namespace {

using Complex = std::complex<double>;
using Branch = Disturbance::Branch;

std::vector<Complex> spectrum(const std::vector<double>& x) {
  std::vector<Complex> out(x.begin(), x.end());
  fourier(out);
  return out;
}

/// Harmonic number that bin k of n stands for.
double harmonic(std::size_t k, std::size_t n) {
  return k <= n / 2 ? static_cast<double>(k) : static_cast<double>(k) - static_cast<double>(n);
}

/// Multiplies a real signal's spectrum by a response, kept conjugate-symmetric.
template <class Response>
void filter(std::vector<Complex>& x, Hertz f, const Response& response) {
  const std::size_t n = x.size();
  for (std::size_t k = 0; k <= n / 2; ++k) {
    const Complex h = response(RadPerSecond{f.rad_s().value * static_cast<double>(k)});
    if (k == 0 || k == n / 2) {
      x[k] *= h.real();
    } else {
      x[k] *= h;
      x[n - k] = std::conj(x[k]);
    }
  }
}

Complex clocked_response(const ClockedCompensator& c, RadPerSecond w) {
  // Beyond half the clock the unit circle repeats; without hold the capacitors' own answer is held at its
  // last value.
  const double cycles = w.hz().value / c.clock.value;
  const double used = c.hold_and_delays ? cycles : std::min(cycles, 0.5);
  const Complex z1 = std::polar(1.0, -2.0 * std::numbers::pi * used);
  Complex h = c.gain;
  for (const auto& section : c.sections) {
    const auto sum = [&](const std::vector<double>& a) {
      Complex out = 0.0;
      for (std::size_t i = a.size(); i-- > 0;) out = out * z1 + a[i];
      return out;
    };
    h *= sum(section.numerator) / sum(section.denominator);
  }
  if (!c.hold_and_delays) return h;
  const double phase = std::numbers::pi * cycles;
  const double sinc = phase == 0.0 ? 1.0 : std::sin(phase) / phase;
  return h * sinc * std::polar(1.0, -phase * (1.0 + 2.0 * c.delay_cycles));
}

std::vector<double> back(std::vector<Complex> x) {
  inverse_fourier(x);
  std::vector<double> out(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) out[i] = x[i].real();
  return out;
}

/// The first while x rises, the second while it falls; at a corner the mean of both.
std::vector<double> switched(const std::vector<double>& rising, const std::vector<double>& falling) {
  const std::size_t n = rising.size();
  std::vector<double> out(n);
  for (std::size_t i = 0; i < n; ++i) out[i] = i < n / 2 ? rising[i] : falling[i];
  for (const std::size_t corner : {std::size_t{0}, n / 2})
    out[corner] = 0.5 * (rising[corner] + falling[corner]);
  return out;
}

}  // namespace

std::complex<double> compensator_response(const Compensator& compensator, RadPerSecond w) {
  if (const auto* constant = std::get_if<ConstantGain>(&compensator)) return constant->gain;
  if (const auto* sections = std::get_if<Sections>(&compensator)) return sections->response(w);
  if (const auto* response = std::get_if<ResponseCompensator>(&compensator)) return response->response(w);
  if (const auto* clocked = std::get_if<ClockedCompensator>(&compensator))
    return clocked_response(*clocked, w);
  return 0.0;
}

PeriodicTracking::PeriodicTracking(const TrackingPlant& plant, const TrackingOptions& options,
                                   Hertz frequency)
    : plant_(plant),
      options_(options),
      frequency_(frequency),
      n_(2 * static_cast<std::size_t>(options.harmonics)),
      generator_(plant.generator ? *plant.generator : plant.disturbance, options,
                 options.place == TrackingOptions::Place::behind_switch),
      own_(plant.disturbance, options),
      gain_{plant.disturbance.rate_gain(Branch::ascending, frequency),
            plant.disturbance.rate_gain(Branch::descending, frequency)} {
  x_.resize(n_);
  stage_.resize(n_);
  std::vector<double> ascending(n_);
  std::vector<double> descending(n_);
  for (std::size_t i = 0; i < n_; ++i) {
    const double theta = static_cast<double>(i) / static_cast<double>(n_);
    const auto g = generator_.sampled(theta);
    const auto s = own_.sampled(theta);
    x_[i] = g.x;
    ascending[i] = g.ascending;
    descending[i] = g.descending;
    stage_[i] = gain_[0] * s.ascending + gain_[1] * s.descending;
  }
  x_hat_ = spectrum(x_);
  ascending_hat_ = spectrum(ascending);
  descending_hat_ = spectrum(descending);
  stage_hat_ = spectrum(stage_);
  for (std::size_t k = 0; k <= n_ / 2; ++k) {
    const RadPerSecond w{frequency.rad_s().value * static_cast<double>(k)};
    drive_.push_back(plant.drive_path.response(w));
    path_.push_back(plant.stage_path.response(w));
  }
}

PeriodicState PeriodicTracking::solve(const TrackingDesign& design, bool with_clocked) const {
  const auto compensated = [&](const Compensator& c, std::vector<Complex> waveform) {
    if (!with_clocked && std::holds_alternative<ClockedCompensator>(c)) {
      std::fill(waveform.begin(), waveform.end(), Complex());
      return waveform;
    }
    filter(waveform, frequency_, [&](RadPerSecond w) { return compensator_response(c, w); });
    return waveform;
  };
  std::vector<Complex> c = compensated(design.ascending, ascending_hat_);
  const std::vector<Complex> other = compensated(design.descending, descending_hat_);
  if (options_.place == TrackingOptions::Place::behind_switch) {
    for (std::size_t k = 0; k < n_; ++k) c[k] += other[k];
  } else {
    c = spectrum(switched(back(std::move(c)), back(other)));
  }
  std::vector<Complex> v(n_);
  for (std::size_t k = 0; k < n_; ++k) {
    const Complex d = k <= n_ / 2 ? drive_[k] : std::conj(drive_[n_ - k]);
    v[k] = (x_hat_[k] - c[k]) * (k == n_ / 2 ? Complex(d.real()) : d);
  }
  std::vector<Complex> q = v;
  if (options_.argument == TrackingOptions::Argument::reference) {
    for (std::size_t k = 0; k < n_; ++k) q[k] += stage_hat_[k];
  } else {
    const std::vector<double> drive = back(v);
    std::vector<double> added(n_);
    for (std::size_t i = 0; i < n_; ++i) {
      const double slope = drive[(i + 1) % n_] - drive[(i + n_ - 1) % n_];
      const Branch branch = slope >= 0.0 ? Branch::ascending : Branch::descending;
      added[i] = gain_[branch == Branch::ascending ? 0 : 1] * own_.branch(branch, drive[i]);
    }
    const auto added_hat = spectrum(added);
    for (std::size_t k = 0; k < n_; ++k) q[k] += added_hat[k];
  }
  for (std::size_t k = 0; k < n_; ++k) {
    const Complex p = k <= n_ / 2 ? path_[k] : std::conj(path_[n_ - k]);
    q[k] *= k == n_ / 2 ? Complex(p.real()) : p;
  }
  PeriodicState out;
  out.compensation = back(std::move(c));
  out.displacement = back(std::move(q));
  return out;
}

LagResult best_lag(const std::vector<double>& y, const std::vector<double>& x, double period_s) {
  const std::size_t n = y.size();
  const auto y_hat = spectrum(y);
  const auto x_hat = spectrum(x);
  // Mean square of y - x(t - lag): constants minus twice the correlation, a short cosine series.
  double constant = 0.0;
  std::vector<Complex> cross(n / 2 + 1);
  const double scale = 1.0 / (static_cast<double>(n) * static_cast<double>(n));
  for (std::size_t k = 0; k < n; ++k) constant += (std::norm(y_hat[k]) + std::norm(x_hat[k])) * scale;
  std::size_t most = 0;
  double largest = 0.0;
  for (std::size_t k = 0; k <= n / 2; ++k) {
    cross[k] = y_hat[k] * std::conj(x_hat[k]) * scale * (k == 0 || k == n / 2 ? 1.0 : 2.0);
    largest = std::max(largest, std::abs(cross[k]));
    if (std::abs(cross[k]) > 1e-15 * largest) most = k;
  }
  const auto correlation_slopes = [&](double lag, double& first, double& second) {
    double sum = 0.0;
    first = second = 0.0;
    const Complex step = std::polar(1.0, 2.0 * std::numbers::pi * lag / period_s);
    Complex turn = 1.0;
    for (std::size_t k = 0; k <= most; ++k) {
      const double w = 2.0 * std::numbers::pi * static_cast<double>(k) / period_s;
      const Complex part = cross[k] * turn;
      sum += part.real();
      first -= w * part.imag();
      second -= w * w * part.real();
      turn *= step;
    }
    return sum;
  };
  // The fundamental's phase starts Newton's method close enough.
  double lag = n > 2 ? -std::arg(cross[1]) / (2.0 * std::numbers::pi) * period_s : 0.0;
  double first = 0.0;
  double second = 0.0;
  double best = correlation_slopes(lag, first, second);
  for (int i = 0; i < 30; ++i) {
    if (!(second < 0.0)) break;
    const double next = lag - first / second;
    const double got = correlation_slopes(next, first, second);
    if (!(got >= best - 1e-18)) break;
    const bool done = std::abs(next - lag) <= 1e-13 * period_s;
    lag = next;
    best = got;
    if (done) break;
  }
  LagResult out;
  out.lag_s = lag;
  // Straight from the difference: the constants nearly cancel.
  double mean_square = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    const double w = 2.0 * std::numbers::pi * harmonic(k, n) / period_s;
    mean_square += std::norm(y_hat[k] - x_hat[k] * std::polar(1.0, -w * lag)) * scale;
  }
  out.rms = std::sqrt(mean_square);
  return out;
}

}  // namespace bodesmith::tracking
