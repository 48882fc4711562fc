#include "tracking/periodic.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "numeric/fourier.hpp"

namespace bodesmith::tracking {
namespace {

/// A first-order lag over a repeating input that is constant from sample to sample, in steady state; the values at
/// the beginning of each interval.
std::vector<double> lagged(const std::vector<double>& input, double step_s, double time_constant_s) {
  if (!(time_constant_s > 0.0)) return input;
  const double keep = std::exp(-step_s / time_constant_s);
  const auto round = [&](double state, std::vector<double>* out) {
    for (std::size_t i = 0; i < input.size(); ++i) {
      if (out != nullptr) (*out)[i] = state;
      state = keep * state + (1.0 - keep) * input[i];
    }
    return state;
  };
  const double all = std::exp(-step_s * static_cast<double>(input.size()) / time_constant_s);
  std::vector<double> out(input.size());
  round(round(0.0, nullptr) / (1.0 - all), &out);
  return out;
}

using Branch = Disturbance::Branch;

std::vector<double> filtered(const std::vector<Complex>& response, const std::vector<double>& x) {
  std::vector<Complex> bins = half_spectrum(x);
  for (std::size_t k = 0; k < bins.size(); ++k) bins[k] *= response[k];
  return from_half_spectrum(bins, x.size());
}

}  // namespace

MeasuredSlope measure_slope(const SlopeGain& gain, const Reference& reference, Hertz operating,
                            std::size_t samples) {
  const double step =
      static_cast<double>(reference.periods()) / (operating.value * static_cast<double>(samples));
  const std::vector<double> r = reference.samples(samples);
  std::vector<double> rate(samples);
  for (std::size_t i = 0; i < samples; ++i) rate[i] = (r[(i + 1) % samples] - r[i]) / step;
  MeasuredSlope out;
  out.slope = lagged(rate, step, gain.differentiator_s);
  std::vector<double> size(samples);
  for (std::size_t i = 0; i < samples; ++i)
    size[i] = 0.5 * (std::abs(out.slope[i]) + std::abs(out.slope[(i + 1) % samples]));
  out.smoothed = lagged(size, step, gain.smoothing_s);
  if (!(gain.smoothing_s > 0.0))
    for (std::size_t i = 0; i < samples; ++i) out.smoothed[i] = std::abs(out.slope[i]);
  for (const double m : out.smoothed) out.frequency_hz.push_back(0.5 * m / reference.alpha());
  return out;
}

PeriodicTracking::PeriodicTracking(const Plant& plant, const Options& options, Hertz frequency)
    : plant_(plant),
      options_(options),
      frequency_(frequency),
      shape_(options.reference, options.alpha),
      n_(2 * options.harmonics * shape_.periods()),
      generator_(plant.generated().at(options.alpha)),
      own_(plant.disturbance.at(options.alpha, frequency)),
      x_(shape_.samples(n_)) {
  for (std::size_t i = 0; i < n_; ++i) {
    const double theta = static_cast<double>(i) / static_cast<double>(n_);
    const std::size_t piece = shape_.piece(theta);
    rising_.push_back(Reference::rises(piece));
    corner_.push_back(shape_.turns()[piece] == theta);
  }
}

std::vector<double> PeriodicTracking::branch_waveform(std::size_t branch,
                                                      const std::vector<double>& heard) const {
  const bool gated = options_.place == Options::Place::behind_switch;
  std::vector<double> w(n_);
  for (std::size_t i = 0; i < n_; ++i) {
    const bool on = !gated || rising_[i] == (branch == 0);
    // Where the switch turns the mean of both sides, which is what a jump's spectrum has there.
    if (gated && corner_[i]) {
      w[i] = 0.5 * generator_.value(kBranches[branch], heard[i]);
    } else if (on) {
      w[i] = generator_.value(kBranches[branch], heard[i]);
    }
  }
  return w;
}

PeriodicTracking::Prepared PeriodicTracking::prepared(const Compensator& compensator) const {
  Prepared out;
  if (std::holds_alternative<Uncompensated>(compensator)) return out;
  if (const auto* constant = std::get_if<ConstantGain>(&compensator)) {
    out.gain.assign(n_, constant->gain);
    return out;
  }
  if (const auto* measured = std::get_if<SlopeGain>(&compensator)) {
    out.gain = measure_slope(*measured, shape_, frequency_, n_).frequency_hz;
    for (double& value : out.gain) value = gain_at(measured->table, value);
    return out;
  }
  for (std::size_t k = 0; k <= n_ / 2; ++k) {
    const RadPerSecond w{2.0 * std::numbers::pi * static_cast<double>(k) / repeat_s()};
    const Complex h = compensator_response(compensator, w);
    out.response.push_back(k == 0 || 2 * k == n_ ? Complex(h.real()) : h);
  }
  return out;
}

std::vector<double> PeriodicTracking::compensated(const Prepared& compensator, std::size_t branch,
                                                  const std::vector<double>& heard) const {
  if (!compensator.response.empty()) return filtered(compensator.response, branch_waveform(branch, heard));
  std::vector<double> out(n_, 0.0);
  if (compensator.gain.empty()) return out;
  // A gain remembers nothing: no spectrum, and no mean at the corners.
  const bool gated = options_.place == Options::Place::behind_switch;
  for (std::size_t i = 0; i < n_; ++i) {
    if (!gated || rising_[i] == (branch == 0))
      out[i] = compensator.gain[i] * generator_.value(kBranches[branch], heard[i]);
  }
  return out;
}

std::vector<double> PeriodicTracking::compensation(const Both& compensators,
                                                   const std::vector<double>& heard) const {
  std::vector<double> up = compensated(compensators[0], 0, heard);
  const std::vector<double> down = compensated(compensators[1], 1, heard);
  const bool picked = options_.place == Options::Place::before_switch;
  for (std::size_t i = 0; i < n_; ++i) {
    if (!picked) {
      up[i] += down[i];
    } else if (!rising_[i]) {
      up[i] = down[i];
    }
  }
  return up;
}

std::vector<double> PeriodicTracking::loop_gain(const Both& compensators,
                                                const std::vector<double>& heard) const {
  std::vector<double> out(n_, 0.0);
  const std::size_t fundamental = shape_.periods();
  for (std::size_t i = 0; i < n_; ++i) {
    const std::size_t branch = rising_[i] ? 0 : 1;
    const Prepared& compensator = compensators[branch];
    double k = 0.0;
    if (!compensator.response.empty()) {
      k = compensator.response[fundamental].real();
    } else if (!compensator.gain.empty()) {
      k = compensator.gain[i];
    }
    out[i] = k * generator_.slope(kBranches[branch], heard[i]);
  }
  return out;
}

std::vector<double> PeriodicTracking::self_fed_drive(const Design& design, const Both& compensators) const {
  // v = x - c(v). A plain round leaves about max |k d'| of the last one's change; divided by 1 + k d', which is Newton's step
  // as far as k is a gain, it leaves what the filter turns and adds. A loop whose gain reaches 1, or that does not come
  // closer so, goes round plainly.
  constexpr int kMostRounds = 200;
  constexpr double kSettled = 1e-11;
  std::vector<double> v = x_;
  bool plain = false;
  double last_change = INFINITY;
  for (int round = 0; round < kMostRounds; ++round) {
    const std::vector<double> c = compensation(compensators, v);
    double change = 0.0;
    for (std::size_t i = 0; i < n_; ++i) change = std::max(change, std::abs(x_[i] - c[i] - v[i]));
    std::vector<double> gain;
    if (!plain) gain = loop_gain(compensators, v);
    const auto steep = [](double k) { return !(std::abs(k) < 1.0); };
    plain = plain || !(change < last_change) || std::ranges::any_of(gain, steep);
    for (std::size_t i = 0; i < n_; ++i) v[i] += (x_[i] - c[i] - v[i]) / (plain ? 1.0 : 1.0 + gain[i]);
    if (change < kSettled) return v;
    if (!(change < 1e3)) break;
    last_change = change;
  }
  throw DesignError(fmt::format(
      "design '{}': the generator fed by its own drive does not settle at {} Hz, expected gains of "
      "less than 1 round the loop",
      design.name, frequency_.value));
}

std::vector<double> PeriodicTracking::stage_disturbance(const std::vector<double>& drive,
                                                        Options::Argument argument) const {
  const bool on_drive = argument == Options::Argument::drive;
  const std::vector<double>& read = on_drive ? drive : x_;
  const std::vector<bool> rising =
      on_drive ? rising_samples(drive, options_.alpha, DriveKind::stepped) : rising_;
  std::vector<double> out(n_);
  for (std::size_t i = 0; i < n_; ++i) out[i] = own_.value(branch_of(rising[i]), read[i]);
  return out;
}

std::vector<double> PeriodicTracking::displacement(const std::vector<double>& drive,
                                                   Options::Argument argument) const {
  const double step = repeat_s() / static_cast<double>(n_);
  if (plant_.stage) return plant_.stage->response(drive, step, frequency_, DriveKind::stepped);
  std::vector<double> q = through_path(plant_.drive_path, drive, step);
  const std::vector<double> added = stage_disturbance(q, argument);
  for (std::size_t i = 0; i < n_; ++i) q[i] += added[i];
  return through_path(plant_.stage_path, q, step);
}

PeriodicState PeriodicTracking::solve(const Design& design) const {
  PeriodicState out;
  const Both compensators = {prepared(design.ascending), prepared(design.descending)};
  if (design.form.is_self_fed()) {
    out.drive = self_fed_drive(design, compensators);
    out.heard.push_back(out.drive);
  } else {
    out.drive = x_;
    for (int pass = 0; pass < design.form.passes; ++pass) {
      out.heard.push_back(out.drive);
      const std::vector<double> c = compensation(compensators, out.heard.back());
      for (std::size_t i = 0; i < n_; ++i) out.drive[i] = x_[i] - c[i];
    }
  }
  for (std::size_t i = 0; i < n_; ++i) out.compensation.push_back(x_[i] - out.drive[i]);
  out.displacement = displacement(out.drive, options_.argument);
  return out;
}

}  // namespace bodesmith::tracking
