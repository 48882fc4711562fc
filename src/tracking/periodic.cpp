#include "tracking/periodic.hpp"

#include <algorithm>
#include <cmath>

#include "tracking/spectrum.hpp"

namespace bodesmith::tracking {
namespace {

using Branch = Disturbance::Branch;

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

/// A response known at the harmonics 0 ... n/2, at bin k of n.
Complex at_bin(const std::vector<Complex>& harmonics, std::size_t k, std::size_t n) {
  const Complex h = k <= n / 2 ? harmonics[k] : std::conj(harmonics[n - k]);
  return k == n / 2 ? Complex(h.real()) : h;
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

void add(std::vector<Complex>& to, const std::vector<Complex>& what) {
  for (std::size_t k = 0; k < to.size(); ++k) to[k] += what[k];
}

}  // namespace

PeriodicTracking::PeriodicTracking(const Plant& plant, const Options& options, Hertz frequency)
    : plant_(plant),
      options_(options),
      frequency_(frequency),
      n_(2 * options.harmonics),
      generator_(plant.generated(), options, options.place == Options::Place::behind_switch),
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

PeriodicTracking::Spectrum PeriodicTracking::compensated(const Compensator& compensator, Spectrum waveform,
                                                         Clocked clocked) const {
  if (clocked == Clocked::left_out && std::holds_alternative<ClockedCompensator>(compensator)) {
    std::fill(waveform.begin(), waveform.end(), Complex());
    return waveform;
  }
  filter(waveform, frequency_, [&](RadPerSecond w) { return compensator_response(compensator, w); });
  return waveform;
}

PeriodicTracking::Spectrum PeriodicTracking::compensation(const Design& design, Clocked clocked) const {
  Spectrum rising = compensated(design.ascending, ascending_hat_, clocked);
  Spectrum falling = compensated(design.descending, descending_hat_, clocked);
  if (options_.place == Options::Place::before_switch) {
    return spectrum(switched(samples_of(std::move(rising)), samples_of(std::move(falling))));
  }
  add(rising, falling);
  return rising;
}

PeriodicTracking::Spectrum PeriodicTracking::stage_spectrum(const Spectrum& v) const {
  if (options_.argument == Options::Argument::reference) return stage_hat_;
  const std::vector<double> drive = samples_of(v);
  std::vector<double> added(n_);
  for (std::size_t i = 0; i < n_; ++i) {
    const double slope = drive[(i + 1) % n_] - drive[(i + n_ - 1) % n_];
    const Branch branch = slope >= 0.0 ? Branch::ascending : Branch::descending;
    added[i] = gain_[branch == Branch::ascending ? 0 : 1] * own_.branch(branch, drive[i]);
  }
  return spectrum(added);
}

PeriodicState PeriodicTracking::solve(const Design& design, Clocked clocked) const {
  Spectrum c = compensation(design, clocked);
  Spectrum q(n_);
  for (std::size_t k = 0; k < n_; ++k) q[k] = (x_hat_[k] - c[k]) * at_bin(drive_, k, n_);
  add(q, stage_spectrum(q));
  for (std::size_t k = 0; k < n_; ++k) q[k] *= at_bin(path_, k, n_);
  return {samples_of(std::move(c)), samples_of(std::move(q))};
}

}  // namespace bodesmith::tracking
