#include "invert/drive_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "base/whole_number.hpp"
#include "numeric/fourier.hpp"
#include "signal/statistics.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::invert {
namespace {

/// Tried for the inverse by structure: little, and more where blocks before or behind dynamics ask for jumps.
constexpr double kSmoothings[] = {3e-4, 1e-2, 0.1, 1.0};

std::vector<chain::Kernel> kernels_of(const chain::Chain& chain) {
  std::vector<chain::Kernel> out;
  for (const chain::Block& block : chain.blocks) out.push_back(block.kernel());
  return out;
}

simulate::RecordOptions record_options(const Options& options, const TimeRecord& reference) {
  return {.start = options.start, .start_s = reference.start_s};
}

bool all_finite(const std::vector<double>& v) {
  return std::ranges::all_of(v, [](double x) { return std::isfinite(x); });
}

}  // namespace

std::vector<double> band_limited(const std::vector<double>& u, double step_s, Hertz bandwidth) {
  const std::size_t n = u.size();
  // u and its reflection 2 u_last - u, a straight line taken out so that the whole is periodic.
  const std::size_t whole = 2 * (n - 1);
  const double rise = 2.0 * (u.back() - u.front());
  const auto line = [&](std::size_t i) {
    return u.front() + rise * static_cast<double>(i) / static_cast<double>(whole);
  };
  std::vector<double> long_signal(whole);
  for (std::size_t i = 0; i < whole; ++i)
    long_signal[i] = (i < n ? u[i] : 2.0 * u.back() - u[whole - i]) - line(i);
  auto bins = half_spectrum(long_signal);
  for (std::size_t k = 0; k < bins.size(); ++k) {
    const double part = static_cast<double>(k) / (static_cast<double>(whole) * step_s) / bandwidth.value;
    if (part > 0.8) bins[k] *= part < 1.0 ? 0.5 + 0.5 * std::cos(std::numbers::pi * (part - 0.8) / 0.2) : 0.0;
  }
  const std::vector<double> low = from_half_spectrum(bins, whole);
  std::vector<double> out(n);
  for (std::size_t i = 0; i < n; ++i) out[i] = (i < whole ? low[i] : low[0]) + line(i);
  return out;
}

DriveSearch::DriveSearch(const chain::Chain& chain, const TimeRecord& reference, const Options& options)
    : chain_(chain),
      reference_(reference),
      options_(options),
      kernels_(kernels_of(chain)),
      simulator_(chain, reference.step_s, record_options(options, reference)),
      delay_s_(total_delay_s(kernels_)),
      refused_samples_(reference.size(), false) {
  target_ = options.preview ? reference.u : later_by(reference.u, delay_s_ / reference.step_s);
}

chain::FoundInput DriveSearch::inverse_of_block(std::size_t index, const chain::WantedOutput& wanted,
                                                bool first) {
  const chain::Block& block = chain_.blocks[index];
  if (auto found = block.inverse(wanted); found && all_finite(found->values)) return *found;
  if (first) without_inverse_.push_back(fmt::format("block {} ({})", index + 1, block.type_name()));
  chain::Chain alone;
  alone.blocks = {block};
  return {by_straight_line(alone, wanted.values), {}};
}

std::vector<double> DriveSearch::by_straight_line(const chain::Chain& blocks,
                                                  const std::vector<double>& wanted) const {
  simulate::RecordSimulator one(blocks, reference_.step_s, record_options(options_, reference_));
  const auto y = one.run(wanted);
  double mean_u = 0.0;
  double mean_y = 0.0;
  const auto n = static_cast<double>(y.size());
  for (std::size_t i = 0; i < y.size(); ++i) {
    mean_u += wanted[i] / n;
    mean_y += y[i] / n;
  }
  double uu = 0.0;
  double uy = 0.0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    uu += (wanted[i] - mean_u) * (wanted[i] - mean_u);
    uy += (wanted[i] - mean_u) * (y[i] - mean_y);
  }
  const double gain = uu > 0.0 ? uy / uu : 0.0;
  std::vector<double> out = wanted;
  if (!std::isfinite(gain) || gain == 0.0) return out;
  for (double& value : out) value = mean_u + (value - mean_y) / gain;
  return out;
}

std::vector<double> DriveSearch::structure_for(const std::vector<double>& aim, bool first) {
  chain::WantedOutput wanted{reference_.start_s, reference_.step_s, aim, options_.preview, smoothing_};
  for (std::size_t i = chain_.blocks.size(); i-- > 0;) {
    stop_if_interrupted();
    chain::FoundInput found = inverse_of_block(i, wanted, first);
    if (first && !found.out_of_reach.empty()) {
      const auto& all = found.out_of_reach;
      refused_.push_back(
          {fmt::format("block {} ({}) gives no such output", i + 1, chain_.blocks[i].type_name()), all.size(),
           reference_.time_s(all.front()), reference_.time_s(all.back())});
      for (const std::size_t at : all) refused_samples_[at] = true;
    }
    wanted.values = std::move(found.values);
  }
  return permitted(std::move(wanted.values));
}

void DriveSearch::by_structure() {
  aim_ = reference_.u;
  drive_ = structure_for(aim_, true);
  output_ = output(drive_);
  const auto [low, high] = std::minmax_element(target_.begin(), target_.end());
  double best = smoothing_;
  for (const double smoothing : kSmoothings) {
    // Where nothing jumps the least is the best.
    if (!(error_rms() > 1e-3 * (*high - *low))) break;
    smoothing_ = smoothing;
    std::vector<double> u = structure_for(aim_, false);
    std::vector<double> y = output(u);
    if (!(cost(u, y) < cost(drive_, output_))) continue;
    best = smoothing;
    drive_ = std::move(u);
    output_ = std::move(y);
  }
  smoothing_ = best;
  if (error_rms() > 1e-3 * (*high - *low)) {
    // An inverse of many blocks may be worse than none.
    std::vector<double> u = permitted(by_straight_line(chain_, reference_.u));
    std::vector<double> y = output(u);
    if (cost(u, y) < cost(drive_, output_)) {
      drive_ = std::move(u);
      output_ = std::move(y);
    }
  }
  // A spring that runs away: smaller drives, until one can be simulated.
  for (int tries = 0; tries < 12 && output_.empty(); ++tries) {
    const double middle = drive_.front();
    for (double& u : drive_) u = middle + 0.5 * (u - middle);
    drive_ = permitted(std::move(drive_));
    output_ = output(drive_);
  }
  if (output_.empty())
    throw DesignError(
        "the model's output grows without bound for every drive tried, expected a stable model");
}

std::vector<double> DriveSearch::permitted(std::vector<double> u) const {
  if (options_.bandwidth) u = band_limited(u, reference_.step_s, *options_.bandwidth);
  options_.limits.hold(u, reference_.step_s);
  return u;
}

/// Empty when the simulation runs away.
std::vector<double> DriveSearch::output(const std::vector<double>& u) {
  if (!all_finite(u)) return {};
  const auto y = simulator_.run(u);
  if (simulator_.diverged()) return {};
  std::vector<double> out(y.begin(), y.end());
  return all_finite(out) ? out : std::vector<double>{};
}

DriveSearch::Signals DriveSearch::signals(const std::vector<double>& u) {
  Signals out{u};
  for (std::size_t k = 1; k <= chain_.blocks.size(); ++k) {
    const auto y = simulator_.run_until(u, k);
    out.emplace_back(y.begin(), y.end());
  }
  return out;
}

/// What the local model weighs: squared errors and, far less, second differences of the drive.
double DriveSearch::cost(const std::vector<double>& u, const std::vector<double>& y) const {
  if (y.empty()) return INFINITY;
  double sum = 0.0;
  for (std::size_t i = 0; i < y.size(); ++i) sum += (target_[i] - y[i]) * (target_[i] - y[i]);
  const double weight = kSmoothings[0] * gain_;
  for (std::size_t i = 1; i + 1 < u.size(); ++i) {
    const double bend = weight * (u[i + 1] - 2.0 * u[i] + u[i - 1]);
    sum += bend * bend;
  }
  return sum;
}

double DriveSearch::error_rms() const {
  return output_.empty() ? INFINITY : error_figures(output_, target_).rms;
}

std::vector<double> DriveSearch::change_towards(const std::vector<double>& y) {
  const double step = reference_.step_s;
  LocalModel model = local_model(kernels_, signals(drive_), step);
  gain_ = model.gain;
  std::vector<double> error(y.size());
  for (std::size_t i = 0; i < y.size(); ++i) error[i] = target_[i] - y[i];
  const double late = model.delay_s / step;
  chain::LocalGoal goal;
  goal.change = later_by(error, -late);
  goal.weight.assign(y.size(), 1.0);
  // What is driven in the last moments comes out behind the record's end.
  const auto lost = whole_number<std::size_t>(std::min(std::floor(late), static_cast<double>(y.size() - 1)));
  std::fill(goal.weight.end() - static_cast<std::ptrdiff_t>(lost), goal.weight.end(), 0.0);
  goal.drive = drive_;
  goal.gain = model.gain;
  goal.smoothing = smoothing_;
  goal.from_rest = options_.start == simulate::Start::equilibrium;
  goal.limits = options_.limits;
  std::vector<double> change = model.chain.change_for(goal);
  const std::size_t last = y.size() - lost - 1;
  std::fill(change.begin() + static_cast<std::ptrdiff_t>(last), change.end(), change[last]);
  return change;
}

/// The whole change or a part of it, if that lowers the cost by `least_gain` of it.
template <class Output>
bool DriveSearch::move(const std::vector<double>& change, Output&& judged, double least_gain) {
  if (!all_finite(change)) return false;
  const double before = cost(drive_, output_);
  for (const double part : {1.0, 0.5, 0.2, 0.05}) {
    std::vector<double> u = drive_;
    for (std::size_t i = 0; i < u.size(); ++i) u[i] += part * change[i];
    u = permitted(std::move(u));
    std::vector<double> y = judged(u);
    if (!(cost(u, y) < (1.0 - least_gain) * before)) continue;
    drive_ = std::move(u);
    output_ = std::move(y);
    ++steps_;
    return true;
  }
  return false;
}

/// The inverse by structure of the reference moved by the error that is left (the other way to learn, which needs no
/// slopes, but inverses that come near).
bool DriveSearch::aim_again(double least_gain) {
  const double before = cost(drive_, output_);
  for (const double part : {1.0, 0.5}) {
    std::vector<double> aim = aim_;
    for (std::size_t i = 0; i < aim.size(); ++i) aim[i] += part * (target_[i] - output_[i]);
    std::vector<double> u = structure_for(aim, false);
    std::vector<double> y = output(u);
    if (!(cost(u, y) < (1.0 - least_gain) * before)) continue;
    aim_ = std::move(aim);
    drive_ = std::move(u);
    output_ = std::move(y);
    ++steps_;
    return true;
  }
  return false;
}

void DriveSearch::improve(int steps) {
  const auto [low, high] = std::minmax_element(target_.begin(), target_.end());
  const double enough = 1e-9 * (*high - *low);
  int left = steps;
  while (left-- > 0 && error_rms() > enough && aim_again(0.5)) stop_if_interrupted();
  const auto judged = [this](const std::vector<double>& u) { return output(u); };
  while (left-- > 0 && error_rms() > enough) {
    stop_if_interrupted();
    if (!move(change_towards(output_), judged, 0.02)) return;
  }
}

void DriveSearch::polish(int steps) {
  const auto [low, high] = std::minmax_element(target_.begin(), target_.end());
  const auto judged = [this](const std::vector<double>& u) { return simulated(u).y; };
  const std::vector<double> rough = output_;
  output_ = judged(drive_);
  double gap = 0.0;
  for (std::size_t i = 0; i < rough.size(); ++i) gap = std::max(gap, std::abs(rough[i] - output_[i]));
  for (int i = 0; i < steps && error_rms() > 1e-9 * (*high - *low) && gap > 0.1 * error_rms(); ++i) {
    stop_if_interrupted();
    if (!move(change_towards(output_), judged, 0.02)) return;
  }
}

simulate::Result DriveSearch::simulated(const std::vector<double>& drive) const {
  TimeRecord record = reference_;
  record.u = drive;
  record.y.clear();
  simulate::Options options;
  options.start = options_.start;
  return simulate::simulate(chain_, record, options);
}

}  // namespace bodesmith::invert
