#include <algorithm>
#include <cmath>
#include <map>

#include "lti/state_space.hpp"
#include "simulate/hold_response.hpp"
#include "tracking/time.hpp"

namespace bodesmith::tracking {
namespace {

using simulate::hold_nodes;
using simulate::HoldResponse;
using simulate::HoldResponseSolver;

/// A switched-capacitor chain, one sample after the other (transposed direct form II).
class SampledChain {
 public:
  explicit SampledChain(const ClockedCompensator& c) : gain_(c.gain) {
    for (const auto& section : c.sections) {
      Filter f;
      const double a0 = section.denominator.at(0);
      const std::size_t order = std::max(section.numerator.size(), section.denominator.size());
      for (std::size_t i = 0; i < order; ++i) {
        f.b.push_back(i < section.numerator.size() ? section.numerator[i] / a0 : 0.0);
        f.a.push_back(i < section.denominator.size() ? section.denominator[i] / a0 : 0.0);
      }
      f.state.assign(order, 0.0);
      filters_.push_back(std::move(f));
    }
  }
  double next(double u) {
    double v = gain_ * u;
    for (Filter& f : filters_) {
      const double y = f.b[0] * v + f.state[0];
      for (std::size_t i = 1; i < f.b.size(); ++i) {
        f.state[i - 1] = f.b[i] * v - f.a[i] * y + (i + 1 < f.b.size() ? f.state[i] : 0.0);
      }
      v = y;
    }
    return v;
  }

 private:
  struct Filter {
    std::vector<double> b, a, state;
  };
  double gain_;
  std::vector<Filter> filters_;
};

/// Samples until the chain has forgotten its start: its impulse response has fallen below 1e-9 of its sum.
std::size_t memory_samples(const ClockedCompensator& c) {
  SampledChain chain(c);
  double total = std::abs(chain.next(1.0));
  std::size_t quiet = 0;
  std::size_t k = 1;
  for (; k < 2000000 && quiet < 32; ++k) {
    const double v = std::abs(chain.next(0.0));
    total += v;
    quiet = v <= 1e-10 * total ? quiet + 1 : 0;
  }
  return k;
}

/// A held output changes, or (before the switch) the switch turns to `branch`.
struct Change {
  double time = 0.0;
  int branch = 0;
  double value = 0.0;
  bool turn = false;
};

/// What the clocked compensators give together.
struct HeldOutputs {
  double held[2] = {0.0, 0.0};
  bool open[2] = {true, true};

  void apply(const Change& change) {
    if (change.turn) {
      open[0] = change.branch == 0;
      open[1] = change.branch == 1;
    } else {
      held[change.branch] = change.value;
    }
  }
  double sum() const { return (open[0] ? held[0] : 0.0) + (open[1] ? held[1] : 0.0); }
};

}  // namespace

TimeTracking track_clocked(const TrackingPlant& plant, const TrackingDesign& design,
                           const TrackingOptions& options, Hertz frequency, int per_period) {
  const double period = 1.0 / frequency.value;
  const bool before_switch = options.place == TrackingOptions::Place::before_switch;
  const TrackingWaveforms generator(plant.generator ? *plant.generator : plant.disturbance, options,
                                    !before_switch);
  const Compensator* parts[2] = {&design.ascending, &design.descending};

  // Whole periods until clock and reference meet again, at most 20.
  int periods = 1;
  for (int m = 1; m <= 20; ++m) {
    periods = m;
    bool whole = true;
    for (const Compensator* part : parts) {
      if (!is_clocked(*part)) continue;
      const double cycles = m * period * std::get<ClockedCompensator>(*part).clock.value;
      whole = whole && std::abs(cycles - std::round(cycles)) < 1e-9 * cycles;
    }
    if (whole) break;
  }
  std::size_t settle_periods = 1;
  for (const Compensator* part : parts) {
    if (!is_clocked(*part)) continue;
    const auto& c = std::get<ClockedCompensator>(*part);
    settle_periods = std::max(
        settle_periods,
        static_cast<std::size_t>(std::ceil((static_cast<double>(memory_samples(c)) + c.delay_cycles + 2.0) /
                                           c.clock.value / period)));
  }
  const double begin = static_cast<double>(settle_periods) * period;
  const double end = begin + periods * period;

  std::vector<Change> changes;
  for (int branch = 0; branch < 2; ++branch) {
    if (!is_clocked(*parts[branch])) continue;
    const auto& c = std::get<ClockedCompensator>(*parts[branch]);
    SampledChain chain(c);
    for (std::size_t k = 0;; ++k) {
      const double t = static_cast<double>(k) / c.clock.value;
      if (t > end) break;
      double theta = t / period;
      theta -= std::floor(theta);
      const auto w = generator.at(theta, theta < 0.5);
      const double value = chain.next(branch == 0 ? w.ascending : w.descending);
      changes.push_back({t + c.delay_cycles / c.clock.value, branch, value, false});
    }
  }
  if (before_switch) {
    for (int half = 0; 0.5 * half * period <= end; ++half)
      changes.push_back({0.5 * half * period, half % 2, 0.0, true});
  }
  std::stable_sort(changes.begin(), changes.end(),
                   [](const Change& p, const Change& q) { return p.time < q.time; });

  // Everything but the staircases.
  TrackingOptions by_reference = options;
  by_reference.argument = TrackingOptions::Argument::reference;
  const PeriodicTracking linear(plant, by_reference, frequency);
  std::vector<double> base = linear.solve(design, false).displacement;
  if (options.argument == TrackingOptions::Argument::drive) {
    // The stage answers to the drive; there the clocked part counts by its smooth share, hold and delay
    // included.
    const PeriodicTracking on_drive(plant, options, frequency);
    const auto with = linear.solve(design).displacement;
    const auto full = on_drive.solve(design).displacement;
    for (std::size_t i = 0; i < base.size(); ++i) base[i] += full[i] - with[i];
  }

  const StateSpace path = in_series(state_space(plant.drive_path), state_space(plant.stage_path));
  const int n = static_cast<int>(path.order());
  std::vector<double> x(static_cast<std::size_t>(n), 0.0);
  std::vector<double> next(x);
  std::map<long long, HoldResponse> known;  // equal intervals are common: clock and samples share a grid
  HoldResponseSolver solver;
  const double tick = 1e-12 * period;
  const auto advance = [&](double dt, double u) {
    if (n == 0 || dt <= 0.0) return;
    const long long key = std::llround(dt / tick);
    auto found = known.find(key);
    if (found == known.end()) {
      if (known.size() > 4096) known.clear();
      found = known.emplace(key, HoldResponse{}).first;
      StateSpace constant = path;
      constant.constant = path.b;
      solver.solve(constant, {}, dt, hold_nodes(1), 1.0, found->second);
    }
    const HoldResponse& r = found->second;
    for (int i = 0; i < n; ++i) {
      double sum = r.k[static_cast<std::size_t>(i)] * u;
      for (int j = 0; j < n; ++j)
        sum += r.e[static_cast<std::size_t>(i * n + j)] * x[static_cast<std::size_t>(j)];
      next[static_cast<std::size_t>(i)] = sum;
    }
    std::swap(x, next);
  };

  TimeTracking out;
  out.per_period = per_period;
  out.periods = periods;
  HeldOutputs outputs;
  std::size_t at = 0;
  // The paths are far faster than a period: one period before the window is enough for them to settle.
  double now = std::max(0.0, begin - period);
  while (at < changes.size() && changes[at].time <= now) {
    outputs.apply(changes[at]);
    ++at;
  }
  const std::size_t count = static_cast<std::size_t>(periods) * static_cast<std::size_t>(per_period);
  const std::size_t stride = base.size() / static_cast<std::size_t>(per_period);
  for (std::size_t i = 0; i < count; ++i) {
    const double when = begin + period * static_cast<double>(i) / per_period;
    while (at < changes.size() && changes[at].time <= when + tick) {
      advance(changes[at].time - now, outputs.sum());
      now = changes[at].time;
      outputs.apply(changes[at]);
      ++at;
    }
    advance(when - now, outputs.sum());
    now = std::max(now, when);
    double y = path.d * outputs.sum();
    for (int j = 0; j < n; ++j) y += path.c[static_cast<std::size_t>(j)] * x[static_cast<std::size_t>(j)];
    out.displacement.push_back(base[(i % static_cast<std::size_t>(per_period)) * stride] - y);
  }
  return out;
}

}  // namespace bodesmith::tracking
