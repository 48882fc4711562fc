#include "tracking/track.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <mutex>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "numeric/parallel_for.hpp"
#include "signal/statistics.hpp"
#include "tracking/continuous.hpp"
#include "tracking/periodic.hpp"

namespace bodesmith::tracking {
namespace {

constexpr std::size_t kSamples = 1024;  ///< a period, in the time domain

/// `count` values evenly from x.
std::vector<double> thinned(const std::vector<double>& x, std::size_t count) {
  std::vector<double> out;
  const std::size_t stride = x.size() / count;
  for (std::size_t i = 0; i < count; ++i) out.push_back(x[i * stride]);
  return out;
}

void validate(const std::string& design, const ScheduledGain& table) {
  if (table.frequency.empty() || table.frequency.size() != table.gain.size()) {
    throw InputError(
        fmt::format("design '{}': the gain's schedule has columns of different length or none", design));
  }
}

void validate(const std::string& design, const Compensator& compensator) {
  if (const auto* scheduled = std::get_if<ScheduledGain>(&compensator)) validate(design, *scheduled);
  if (const auto* measured = std::get_if<SlopeGain>(&compensator)) validate(design, measured->table);
  if (const auto* sum = std::get_if<FilterAndSchedule>(&compensator)) validate(design, sum->schedule);
}

void validate(const Plant& plant, const std::vector<Design>& designs, const Options& options) {
  if (options.frequencies.empty()) throw InputError("no operating frequency to track, expected at least one");
  for (const Hertz f : options.frequencies) {
    if (!(f.value > 0.0) || !std::isfinite(f.value))
      throw InputError("an operating frequency is not above 0 Hz");
  }
  if (!(options.alpha > 0.0)) throw InputError("the reference amplitude alpha is not above 0");
  if (!(plant.stroke > 0.0)) throw InputError("the stroke is not above 0");
  if (options.harmonics < kSamples || !std::has_single_bit(options.harmonics)) {
    throw std::logic_error("tracking needs a power of two, 1024 or more, of harmonics");
  }
  for (const Design& design : designs) {
    validate(design.name, design.ascending);
    validate(design.name, design.descending);
    if (design.form.passes < 0)
      throw InputError(fmt::format("design '{}': a generator of fewer than no passes", design.name));
  }
}

/// y/stroke over whole repeats and x over one, with as many samples a repeat.
struct Tracked {
  std::vector<double> displacement;
  std::vector<double> reference;
  std::optional<Case::Check> check;
  std::optional<ContinuousRun> in_time;
};

/// In the time domain where that is wanted and the design has one, checked by the harmonic computation.
Tracked displacement_of(const Plant& plant, const Design& design, const Options& options,
                        const PeriodicTracking& periodic, const PeriodicState& state) {
  Tracked out{state.displacement, periodic.reference(), std::nullopt, std::nullopt};
  if (!options.time_domain || plant.stage) return out;
  const std::size_t samples = kSamples * periodic.form().periods();
  out.in_time = track_continuous(plant, design, options, periodic, state, samples);
  if (!out.in_time) return out;
  out.displacement = out.in_time->samples;
  const std::vector<double> coarse = thinned(state.displacement, samples);
  out.reference = thinned(periodic.reference(), samples);
  out.check = Case::Check{plain_error(state.displacement, periodic.reference()).rms_percent,
                          plain_error(out.displacement, coarse).rms_percent};
  return out;
}

void keep_waveforms(const std::vector<double>& x, const std::vector<double>& y, double period, double stroke,
                    std::size_t count, Case& out) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = i * x.size() / count;
    out.time_s.push_back(period * static_cast<double>(at) / static_cast<double>(x.size()));
    out.reference.push_back(stroke * x[at]);
    out.displacement.push_back(stroke * y[at]);
  }
}

/// All designs at one frequency.
std::vector<Case> track_at(const Plant& plant, const std::vector<Design>& designs, const Options& options,
                           Hertz frequency) {
  const PeriodicTracking periodic(plant, options, frequency);
  const double period = periodic.repeat_s();
  std::vector<PeriodicState> states;
  std::vector<Case> out;
  for (Design design : designs) {
    stop_if_interrupted();
    design.ascending = settled_at(design.ascending, frequency);
    design.descending = settled_at(design.descending, frequency);
    states.push_back(periodic.solve(design));
    const std::vector<double>& compensation = states.back().compensation;
    const Tracked waves = displacement_of(plant, design, options, periodic, states.back());
    const std::size_t samples = waves.reference.size();
    const std::vector<double> last(waves.displacement.end() - static_cast<std::ptrdiff_t>(samples),
                                   waves.displacement.end());
    Case& c = out.emplace_back();
    c.frequency = frequency;
    c.design = design.name;
    static_cast<TrackingError&>(c) = plain_error(waves.displacement, waves.reference);
    const TrackingError settled = tracking_error(last, waves.reference, period);
    c.lag_s = settled.lag_s;
    c.rms_percent_without_lag = settled.rms_percent_without_lag;
    if (waves.in_time) {
      const auto [low, high] = std::ranges::minmax(waves.in_time->nodes, {}, &ContinuousRun::Node::y);
      const auto [least, most] = std::ranges::minmax(waves.in_time->samples);
      c.range = std::max(high.y, most) - std::min(low.y, least);
      const auto percent = [&](double lag_s) {
        return 100.0 * waves.in_time->rms(periodic.form(), period, lag_s) / c.range;
      };
      c.rms_percent = percent(0.0);
      c.rms_percent_without_lag = percent(c.lag_s);
    }
    c.check = waves.check;
    if (options.also_on_reference) {
      const std::vector<double> y = periodic.displacement(states.back().drive, Options::Argument::reference);
      c.on_reference_percent = plain_error(y, periodic.reference()).rms_percent;
    }
    for (std::size_t i = 0; i + 1 < states.size(); ++i) {
      if (designs[i].name != design.made_from) continue;
      c.lost_rms_percent = 100.0 * error_figures(compensation, states[i].compensation).rms / options.alpha;
    }
    keep_waveforms(waves.reference, last, period, plant.stroke, options.keep_samples, c);
  }
  return out;
}

}  // namespace

Report track(const Plant& plant, const std::vector<Design>& designs, const Options& options) {
  validate(plant, designs, options);
  Progress progress("tracking");
  Report report;
  // The highest frequencies, listed last as a rule, are the longest work.
  std::vector<std::vector<Case>> cases(options.frequencies.size());
  std::size_t done = 0;
  std::mutex shown;
  parallel_for(cases.size(), thread_count(0), [&](std::size_t i) {
    const std::size_t at = cases.size() - 1 - i;
    cases[at] = track_at(plant, designs, options, options.frequencies[at]);
    const std::lock_guard lock(shown);
    progress.at(static_cast<double>(++done) / static_cast<double>(cases.size()));
  });
  for (std::vector<Case>& at : cases)
    for (Case& c : at) report.cases.push_back(std::move(c));
  return report;
}

const Case* Report::find(Hertz frequency, const std::string& design) const {
  const auto found = std::ranges::find_if(
      cases, [&](const Case& c) { return c.frequency == frequency && c.design == design; });
  return found == cases.end() ? nullptr : &*found;
}

}  // namespace bodesmith::tracking
