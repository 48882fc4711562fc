#include "tracking/clocked.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/whole_number.hpp"
#include "lti/state_space.hpp"
#include "simulate/hold_response.hpp"
#include "tracking/sampled_filter.hpp"
#include "tracking/waveforms.hpp"

namespace bodesmith::tracking {
namespace {

using simulate::hold_nodes;
using simulate::HoldResponse;
using simulate::HoldResponseSolver;

/// The clocked compensators of both branches; null where a branch has none.
using ClockedParts = std::array<const ClockedCompensator*, 2>;

/// A held output changes, or (before the switch) the switch turns to `branch`.
struct Change {
  double time = 0.0;
  std::size_t branch = 0;
  double value = 0.0;
  bool turn = false;
};

/// What the clocked compensators give together.
struct HeldOutputs {
  std::array<double, 2> held = {0.0, 0.0};
  std::array<bool, 2> open = {true, true};

  void apply(const Change& change) {
    if (change.turn) {
      open = {change.branch == 0, change.branch == 1};
    } else {
      held[change.branch] = change.value;
    }
  }
  double sum() const { return (open[0] ? held[0] : 0.0) + (open[1] ? held[1] : 0.0); }
};

/// Whole periods until clock and reference meet again, at most 20.
int common_periods(const ClockedParts& parts, double period) {
  constexpr int kMaxPeriods = 20;
  for (int m = 1; m < kMaxPeriods; ++m) {
    const bool whole = std::all_of(parts.begin(), parts.end(), [&](const ClockedCompensator* part) {
      if (part == nullptr) return true;
      const double cycles = m * period * part->clock.value;
      return std::abs(cycles - std::round(cycles)) < 1e-9 * cycles;
    });
    if (whole) return m;
  }
  return kMaxPeriods;
}

/// Whole periods after which the filters have forgotten their start.
double settling_periods(const ClockedParts& parts, double period) {
  double out = 1.0;
  for (const ClockedCompensator* part : parts) {
    if (part == nullptr) continue;
    const double cycles = static_cast<double>(memory_samples(*part)) + part->delay_cycles + 2.0;
    out = std::max(out, std::ceil(cycles / part->clock.value / period));
  }
  return out;
}

/// Everything that happens from t = 0 to `end`, in order of time.
std::vector<Change> changes_until(double end, const ClockedParts& parts, const BranchCurve& generator,
                                  const Reference& reference, double period, bool before_switch) {
  std::vector<Change> out;
  for (std::size_t branch = 0; branch < 2; ++branch) {
    if (parts[branch] == nullptr) continue;
    const ClockedCompensator& c = *parts[branch];
    SampledFilter filter(c);
    for (std::size_t k = 0;; ++k) {
      const double t = static_cast<double>(k) / c.clock.value;
      if (t > end) break;
      double theta = t / period;
      theta -= std::floor(theta);
      const bool heard = before_switch || Reference::rises(reference.piece(theta)) == (branch == 0);
      const double value = filter.next(heard ? generator.value(branch, reference.value(theta)) : 0.0);
      out.push_back({t + c.delay_cycles / c.clock.value, branch, value, false});
    }
  }
  if (before_switch) {
    for (std::size_t repeat = 0; static_cast<double>(repeat) * period <= end; ++repeat) {
      for (std::size_t piece = 0; piece < reference.turns().size(); ++piece) {
        const double t = (static_cast<double>(repeat) + reference.turns()[piece]) * period;
        out.push_back({t, Reference::rises(piece) ? std::size_t{0} : std::size_t{1}, 0.0, true});
      }
    }
  }
  std::stable_sort(out.begin(), out.end(), [](const Change& p, const Change& q) { return p.time < q.time; });
  return out;
}

/// What the stage reads without the staircases, over one repeat.
std::vector<double> smooth_drive(const Plant& plant, const Design& design, const PeriodicTracking& periodic) {
  const std::vector<double> v = periodic.solve(design, PeriodicTracking::Clocked::left_out).drive;
  return through_path(plant.drive_path, v, periodic.repeat_s() / static_cast<double>(v.size()));
}

/// y/stroke of a stage that reads u (behind the drive path), over whole repeats.
std::vector<double> answer(const Plant& plant, const Options& options, const PeriodicTracking& periodic,
                           std::vector<double> u, std::size_t per_repeat) {
  const double step = periodic.repeat_s() / static_cast<double>(per_repeat);
  const BranchCurve own(plant.disturbance, options.alpha, periodic.frequency());
  const bool on_drive = options.argument == Options::Argument::drive;
  const std::vector<bool> rising = rising_samples(u, 0.02 * options.alpha);
  for (std::size_t i = 0; i < u.size(); ++i) {
    const double theta = static_cast<double>(i % per_repeat) / static_cast<double>(per_repeat);
    const bool up = on_drive ? rising[i] : Reference::rises(periodic.form().piece(theta));
    u[i] += own.value(up ? 0 : 1, on_drive ? u[i] : periodic.form().value(theta));
  }
  return through_path(plant.stage_path, u, step);
}

/// A linear system under a staircase.
class StaircasePath {
 public:
  /// `tick`: intervals that differ by less count as equal.
  StaircasePath(StateSpace system, double tick)
      : system_(std::move(system)), tick_(tick), x_(system_.order(), 0.0), next_(x_) {}

  void advance(double dt, double u) {
    const std::size_t n = x_.size();
    if (n == 0 || dt <= 0.0) return;
    const HoldResponse& r = response_over(dt);
    for (std::size_t i = 0; i < n; ++i) {
      double sum = r.k[i] * u;
      for (std::size_t j = 0; j < n; ++j) sum += r.e[i * n + j] * x_[j];
      next_[i] = sum;
    }
    std::swap(x_, next_);
  }
  double value(double u) const { return output(system_, u, x_.data()); }

 private:
  const HoldResponse& response_over(double dt) {
    // Equal intervals are common: clock and samples share a grid.
    constexpr std::size_t kMaxKept = 4096;
    const auto key = whole_number<long long>(std::round(dt / tick_));
    auto found = known_.find(key);
    if (found == known_.end()) {
      if (known_.size() > kMaxKept) known_.clear();
      found = known_.emplace(key, HoldResponse{}).first;
      // The input is a constant over the interval.
      solver_.solve({x_.size(), system_.a.data(), {}, system_.b.data()}, dt, hold_nodes(1), 1.0,
                    found->second);
    }
    return found->second;
  }

  StateSpace system_;
  double tick_;
  std::vector<double> x_, next_;
  std::map<long long, HoldResponse> known_;
  HoldResponseSolver solver_;
};

}  // namespace

std::vector<double> track_clocked(const Plant& plant, const Design& design, const Options& options,
                                  const PeriodicTracking& periodic, std::size_t per_repeat) {
  const double repeat = periodic.repeat_s();
  const bool before_switch = options.place == Options::Place::before_switch;
  const ClockedParts parts = {clocked_part(design.ascending), clocked_part(design.descending)};
  const int repeats = common_periods(parts, repeat);
  const double begin = settling_periods(parts, repeat) * repeat;
  const BranchCurve generator(plant.generated(), options.alpha);
  const std::vector<Change> changes =
      changes_until(begin + repeats * repeat, parts, generator, periodic.form(), repeat, before_switch);
  const std::vector<double> smooth = smooth_drive(plant, design, periodic);
  const double tick = 1e-12 * repeat;
  StaircasePath path(state_space(plant.drive_path), tick);

  std::vector<double> drive;
  HeldOutputs outputs;
  auto change = changes.begin();
  // The path is far faster than a repeat: one repeat before the window is enough for it to settle.
  double now = std::max(0.0, begin - repeat);
  for (; change != changes.end() && change->time <= now; ++change) outputs.apply(*change);
  const std::size_t count = static_cast<std::size_t>(repeats) * per_repeat;
  const std::size_t stride = smooth.size() / per_repeat;
  for (std::size_t i = 0; i < count; ++i) {
    const double when = begin + repeat * static_cast<double>(i) / static_cast<double>(per_repeat);
    for (; change != changes.end() && change->time <= when + tick; ++change) {
      path.advance(change->time - now, outputs.sum());
      now = change->time;
      outputs.apply(*change);
    }
    path.advance(when - now, outputs.sum());
    now = std::max(now, when);
    drive.push_back(smooth[(i % per_repeat) * stride] - path.value(outputs.sum()));
  }
  return answer(plant, options, periodic, std::move(drive), per_repeat);
}

}  // namespace bodesmith::tracking
