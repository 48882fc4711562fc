#include "tracking/tracking.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/json.hpp"
#include "base/progress.hpp"
#include "tracking/periodic.hpp"
#include "tracking/time.hpp"

namespace bodesmith::tracking {
namespace {

constexpr int kSamples = 1024;  ///< a period, in the time domain

double rms_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

std::vector<double> thinned(const std::vector<double>& x, int count) {
  std::vector<double> out;
  const std::size_t stride = x.size() / static_cast<std::size_t>(count);
  for (int i = 0; i < count; ++i) out.push_back(x[static_cast<std::size_t>(i) * stride]);
  return out;
}

struct Error {
  double rms_percent = 0.0;
  double max_percent = 0.0;
  double range = 0.0;
};

/// Eq. 8 over whole periods; the reference has one.
Error error_of(const std::vector<double>& y, const std::vector<double>& x) {
  const auto [low, high] = std::minmax_element(y.begin(), y.end());
  Error out;
  out.range = *high - *low;
  double sum = 0.0;
  double most = 0.0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    const double e = y[i] - x[i % x.size()];
    sum += e * e;
    most = std::max(most, std::abs(e));
  }
  out.rms_percent = 100.0 * std::sqrt(sum / static_cast<double>(y.size())) / out.range;
  out.max_percent = 100.0 * most / out.range;
  return out;
}

void check(const TrackingPlant& plant, const std::vector<TrackingDesign>& designs,
           const TrackingOptions& options) {
  if (options.frequencies.empty()) throw InputError("no operating frequency to track, expected at least one");
  for (const Hertz f : options.frequencies) {
    if (!(f.value > 0.0) || !std::isfinite(f.value))
      throw InputError("an operating frequency is not above 0 Hz");
  }
  if (!(options.alpha > 0.0)) throw InputError("the reference amplitude alpha is not above 0");
  if (!(plant.stroke > 0.0)) throw InputError("the stroke is not above 0");
  if (options.harmonics < kSamples || (options.harmonics & (options.harmonics - 1)) != 0) {
    throw std::logic_error("tracking needs a power of two, 1024 or more, of harmonics");
  }
  for (const TrackingDesign& d : designs) {
    for (const Compensator* c : {&d.ascending, &d.descending}) {
      const auto* scheduled = std::get_if<ScheduledGain>(c);
      if (scheduled != nullptr &&
          (scheduled->frequency.empty() || scheduled->frequency.size() != scheduled->gain.size())) {
        throw InputError(
            fmt::format("design '{}': the gain's schedule has columns of different length or none", d.name));
      }
      const auto* clocked = std::get_if<ClockedCompensator>(c);
      if (clocked != nullptr && !(clocked->clock.value > 0.0)) {
        throw InputError(fmt::format("design '{}': the clock is not above 0 Hz", d.name));
      }
    }
  }
}

/// The design as it is at one operating frequency: a scheduled gain has become a constant one.
TrackingDesign settled_at(const TrackingDesign& design, Hertz frequency) {
  TrackingDesign out = design;
  for (Compensator* part : {&out.ascending, &out.descending}) {
    const auto* scheduled = std::get_if<ScheduledGain>(part);
    if (scheduled == nullptr) continue;
    Disturbance table;
    table.rate = {scheduled->frequency, scheduled->gain, scheduled->gain};
    *part = ConstantGain{table.rate_gain(Disturbance::Branch::ascending, frequency)};
  }
  return out;
}

}  // namespace

const TrackingCase* TrackingReport::find(Hertz frequency, const std::string& design) const {
  for (const TrackingCase& c : cases) {
    if (c.frequency == frequency && c.design == design) return &c;
  }
  return nullptr;
}

Json TrackingReport::to_json(bool with_waveforms) const {
  Json out;
  out["cases"] = Json::array();
  for (const TrackingCase& c : cases) {
    Json item = {{"frequency_hz", c.frequency.value},
                 {"design", c.design},
                 {"rms_percent", c.rms_percent},
                 {"max_percent", c.max_percent},
                 {"lag_s", c.lag_s},
                 {"rms_percent_without_lag", c.rms_percent_without_lag},
                 {"waveform_rms_percent", c.waveform_rms_percent},
                 {"lost_rms_percent", c.lost_rms_percent},
                 {"method", c.method}};
    if (!c.check_method.empty()) {
      item["check"] = {{"method", c.check_method},
                       {"rms_percent", c.check_rms_percent},
                       {"difference_percent", c.check_difference_percent}};
    }
    if (with_waveforms) {
      item["time_s"] = c.time_s;
      item["reference"] = c.reference;
      item["displacement"] = c.displacement;
    }
    out["cases"].push_back(std::move(item));
  }
  return out;
}

TrackingReport track(const TrackingPlant& plant, const std::vector<TrackingDesign>& designs,
                     const TrackingOptions& options) {
  check(plant, designs, options);
  const Stopwatch watch;
  Progress progress("tracking");
  TrackingReport report;
  const double total = static_cast<double>(options.frequencies.size() * designs.size());
  for (const Hertz f : options.frequencies) {
    const PeriodicTracking periodic(plant, options, f);
    const double period = 1.0 / f.value;
    std::vector<PeriodicState> states;
    for (const TrackingDesign& wanted : designs) {
      stop_if_interrupted();
      const TrackingDesign design = settled_at(wanted, f);
      states.push_back(periodic.solve(design));
      const PeriodicState& state = states.back();
      TrackingCase c;
      c.frequency = f;
      c.design = design.name;

      std::vector<double> y = state.displacement;
      std::vector<double> x = periodic.reference();
      c.method = "harmonic";
      std::optional<TimeTracking> time;
      if (options.time_domain) {
        if (is_clocked(design.ascending) || is_clocked(design.descending)) {
          time = track_clocked(plant, design, options, f, kSamples);
          c.method = "exact";
          c.check_method = "harmonic, without the clock's images";
        } else {
          time = track_in_cvode(plant, design, options, f, kSamples);
          if (time) {
            c.method = "cvode";
            c.check_method = "harmonic";
          }
        }
      }
      if (time) {
        const std::vector<double> coarse = thinned(state.displacement, kSamples);
        x = thinned(periodic.reference(), kSamples);
        c.check_rms_percent = error_of(coarse, x).rms_percent;
        y = time->displacement;
        double sum = 0.0;
        for (std::size_t i = 0; i < y.size(); ++i) sum += std::pow(y[i] - coarse[i % coarse.size()], 2);
        c.check_difference_percent =
            100.0 * std::sqrt(sum / static_cast<double>(y.size())) / error_of(y, x).range;
      }
      const Error error = error_of(y, x);
      c.rms_percent = error.rms_percent;
      c.max_percent = error.max_percent;
      const std::vector<double> last(y.end() - static_cast<std::ptrdiff_t>(x.size()), y.end());
      const LagResult lag = best_lag(last, x, period);
      c.lag_s = lag.lag_s;
      c.rms_percent_without_lag = 100.0 * lag.rms / error.range;
      c.waveform_rms_percent =
          100.0 * rms_difference(state.compensation, periodic.stage_disturbance()) / options.alpha;
      for (std::size_t i = 0; i + 1 < states.size(); ++i) {
        if (designs[i].name != design.made_from) continue;
        c.lost_rms_percent =
            100.0 * rms_difference(state.compensation, states[i].compensation) / options.alpha;
      }
      for (int i = 0; i < options.keep_samples; ++i) {
        const std::size_t at =
            static_cast<std::size_t>(i) * x.size() / static_cast<std::size_t>(options.keep_samples);
        c.time_s.push_back(period * static_cast<double>(at) / static_cast<double>(x.size()));
        c.reference.push_back(plant.stroke * x[at]);
        c.displacement.push_back(plant.stroke * last[at]);
      }
      report.cases.push_back(std::move(c));
      progress.at(static_cast<double>(report.cases.size()) / total);
    }
  }
  report.compute_s = watch.seconds();
  return report;
}

Sections lowpass_path(Hertz corner) {
  Section s;
  s.gain = corner.rad_s().value;
  s.poles = {-corner.rad_s().value};
  return Sections{1.0, {s}, std::nullopt};
}

Sections seed_damping_compensator() {
  const auto roots = [](double linear, double constant) {
    const double im = std::sqrt(constant - 0.25 * linear * linear);
    return std::vector<std::complex<double>>{{-0.5 * linear, im}, {-0.5 * linear, -im}};
  };
  Section s;
  s.gain = 0.86;
  s.zeros = roots(9.854e4, 1.67e11);
  s.poles = roots(1.917e5, 1.436e11);
  return Sections{1.0, {s}, std::nullopt};
}

Sections resonance_path(Hertz natural_frequency, double damping_ratio) {
  const double w = natural_frequency.rad_s().value;
  Section s;
  s.gain = w * w;
  if (damping_ratio < 1.0) {
    const double im = w * std::sqrt(1.0 - damping_ratio * damping_ratio);
    s.poles = {{-damping_ratio * w, im}, {-damping_ratio * w, -im}};
  } else {
    const double root = std::sqrt(damping_ratio * damping_ratio - 1.0);
    s.poles = {-w * (damping_ratio - root), -w * (damping_ratio + root)};
  }
  return Sections{1.0, {s}, std::nullopt};
}

Sections in_series(const std::vector<Sections>& paths) {
  Sections out;
  for (const Sections& path : paths) {
    out.gain *= path.gain;
    out.sections.insert(out.sections.end(), path.sections.begin(), path.sections.end());
  }
  return out;
}

}  // namespace bodesmith::tracking
