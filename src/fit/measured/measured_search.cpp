#include "fit/measured/measured_search.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "signal/statistics.hpp"

namespace bodesmith {
namespace {

using Complex = std::complex<double>;
using PoleList = std::vector<Complex>;

constexpr double kZeroReach = 30.0;  ///< zeros this far above the highest frequency are taken as gain
constexpr int kRelocations = 20;
constexpr int kRefinements = 30;

/// `order` lightly damped poles over the band, even in frequency where `linear`, else in its logarithm.
PoleList spread_poles(const std::vector<Complex>& s, int order, bool linear) {
  const double low = s.front().imag();
  const double high = s.back().imag();
  PoleList out;
  const int pairs = order / 2;
  for (int i = 0; i < pairs; ++i) {
    const double t = (i + 0.5) / pairs;
    const double w = linear ? low + t * (high - low) : low * std::pow(high / low, t);
    out.emplace_back(-0.02 * w, w);
    out.emplace_back(-0.02 * w, -w);
  }
  if (order % 2 != 0) out.emplace_back(-std::sqrt(low * high), 0.0);
  return out;
}

/// Real poles, even in ln frequency: for lag-like responses.
PoleList real_poles(const std::vector<Complex>& s, int order) {
  const double low = s.front().imag();
  const double high = s.back().imag();
  PoleList out;
  for (int i = 0; i < order; ++i) out.emplace_back(-low * std::pow(high / low, (i + 0.5) / order), 0.0);
  return out;
}

}  // namespace

MeasuredSearch::MeasuredSearch(const ResponseSamples& samples, bool with_delay)
    : samples_(samples), with_delay_(with_delay), largest_s_(samples.s.back().imag()) {
  FactoredResponse none;
  none.cost = -1.0;
  found_.assign(1, none);
  if (with_delay_) find_delay();
}

void MeasuredSearch::find_delay() {
  // What is left of the phase's slope over the upper third of what stands clear of the noise.
  std::vector<std::size_t> clear;
  for (std::size_t i = 0; i < samples_.s.size(); ++i) {
    if (std::abs(samples_.response[i]) > 8.0 * samples_.deviation[i]) clear.push_back(i);
  }
  std::vector<double> slopes;
  for (std::size_t k = 2 * clear.size() / 3 + 1; k < clear.size(); ++k) {
    const std::size_t i = clear[k];
    const std::size_t before = clear[k - 1];
    const double step = std::arg(samples_.response[i] * std::conj(samples_.response[before]));
    slopes.push_back(-step / (samples_.s[i] - samples_.s[before]).imag());
  }
  if (slopes.empty()) return;
  const double slope = median(std::move(slopes));
  if (!(slope * largest_s_ > 0.05)) return;
  double best = INFINITY;
  const int order = static_cast<int>(std::clamp<std::size_t>(samples_.s.size() / 6, 1, 6));
  for (const double share : {0.0, 0.1, 0.25, 0.5, 0.8, 1.0, 1.1}) {
    double cost = INFINITY;
    for (const bool linear : {false, true}) {
      cost = std::min(cost, from_poles(spread_poles(samples_.s, order, linear), share * slope, 5).cost);
    }
    if (cost < 0.98 * best) {
      best = cost;
      delay_ = share * slope;
    }
  }
}

FactoredResponse MeasuredSearch::from_poles(PoleList poles, double delay, int rounds) const {
  ResponseSamples undelayed;
  const ResponseSamples* samples = &samples_;
  if (delay != 0.0) {
    undelayed = samples_;
    for (std::size_t i = 0; i < undelayed.s.size(); ++i)
      undelayed.response[i] *= std::exp(undelayed.s[i] * delay);
    samples = &undelayed;
  }
  const RationalRoots roots = vector_fit(*samples, std::move(poles), rounds);
  FactoredResponse out = FactoredResponse::of(roots, largest_s_, kZeroReach);
  out.delay = delay;
  out.fits_delay = with_delay_;
  out.cost = roots.cost;
  return out;
}

Complex MeasuredSearch::worst_place(const FactoredResponse& model) const {
  // The window of most error.
  const std::size_t count = samples_.s.size();
  const std::size_t half = std::max<std::size_t>(1, count / 100);
  std::vector<double> sums{0.0};
  for (std::size_t i = 0; i < count; ++i) {
    sums.push_back(sums[i] +
                   std::norm((model.response(samples_.s[i]) - samples_.response[i]) / samples_.deviation[i]));
  }
  std::size_t worst = half;
  for (std::size_t i = half; i + half < count; ++i) {
    if (sums[i + half + 1] - sums[i - half] > sums[worst + half + 1] - sums[worst - half]) worst = i;
  }
  const double w = samples_.s[worst].imag();
  return {-0.02 * w, w};
}

std::vector<PoleList> MeasuredSearch::starts(int order) const {
  std::vector<PoleList> out{spread_poles(samples_.s, order, false), spread_poles(samples_.s, order, true)};
  if (order <= 6) out.push_back(real_poles(samples_.s, order));
  const auto known = [&](int n) {
    return n >= 1 && static_cast<std::size_t>(n) < found_.size() &&
           found_[static_cast<std::size_t>(n)].cost >= 0.0;
  };
  if (known(order - 1)) {
    PoleList more = found_[static_cast<std::size_t>(order - 1)].pole_roots();
    more.emplace_back(-worst_place(found_[static_cast<std::size_t>(order - 1)]).imag(), 0.0);
    out.push_back(std::move(more));
  }
  if (known(order - 2)) {
    const FactoredResponse& before = found_[static_cast<std::size_t>(order - 2)];
    PoleList more = before.pole_roots();
    const Complex place = worst_place(before);
    more.push_back(place);
    more.push_back(std::conj(place));
    out.push_back(std::move(more));
  }
  return out;
}

FactoredResponse MeasuredSearch::settled(FactoredResponse model) const {
  // A ring of zeros beyond the band gives way slowly.
  for (int round = 0; round < 4; ++round) {
    FactoredResponse next = without_far_zeros(refine(model, samples_, kRefinements), samples_);
    const bool rests = next.converged || !(next.cost < 0.997 * model.cost);
    model = std::move(next);
    if (rests) break;
  }
  return model;
}

const FactoredResponse& MeasuredSearch::of_order(int order) {
  const std::size_t at = static_cast<std::size_t>(order);
  FactoredResponse untried;
  untried.cost = -1.0;
  if (found_.size() <= at) found_.resize(at + 1, untried);
  if (found_[at].cost >= 0.0) return found_[at];
  std::vector<FactoredResponse> begun;
  const std::vector<PoleList> all = starts(order);
  for (const PoleList& start : all) begun.push_back(from_poles(start, delay_, kRelocations));
  // The order before may have found a better delay, or, with too few poles, a worse one.
  if (at > 0 && found_[at - 1].cost >= 0.0 && std::abs(found_[at - 1].delay - delay_) > 0.02 / largest_s_) {
    for (const PoleList& start : all) begun.push_back(from_poles(start, found_[at - 1].delay, kRelocations));
  }
  std::ranges::stable_sort(begun, {}, &FactoredResponse::cost);
  FactoredResponse best;
  best.cost = INFINITY;
  const double noise = 2.0 * static_cast<double>(samples_.s.size());
  for (std::size_t i = 0; i < std::min<std::size_t>(2, begun.size()); ++i) {
    if (i > 0 && best.cost < noise) break;
    FactoredResponse refined = settled(begun[i]);
    if (refined.cost < best.cost) best = std::move(refined);
  }
  found_[at] = std::move(best);
  return found_[at];
}

}  // namespace bodesmith
