#include "fit/direct/start_builder.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/progress.hpp"
#include "numeric/parallel_for.hpp"

namespace bodesmith {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr std::size_t kGrown = 4;  ///< so many of the smaller models grow
constexpr int kPlaces = 11;        ///< evenly over log frequency: where the new roots go

/// Corners of the zeros and the poles, as ln; how starts are built, whatever the model.
struct Corners {
  std::vector<double> zeros;
  std::vector<double> poles;
};

VectorXd theta_of(const RootModel& model, Corners corners, const std::vector<double>& pair_damping,
                  double log_gain) {
  VectorXd theta(model.size());
  theta(0) = log_gain;
  Index at = 1;
  std::size_t damping = 0;
  std::ranges::sort(corners.zeros);
  std::ranges::sort(corners.poles);
  for (const bool zero : {true, false}) {
    const auto& list = zero ? corners.zeros : corners.poles;
    const auto reals = static_cast<std::size_t>(zero ? model.real_zeros : model.real_poles);
    const auto pairs = static_cast<std::size_t>(zero ? model.zero_pairs : model.pole_pairs);
    for (std::size_t i = 0; i < reals; ++i) theta(at++) = list[2 * pairs + i];
    for (std::size_t i = 0; i < pairs; ++i) {
      const double half = 0.5 * (list[2 * i + 1] - list[2 * i]);
      theta(at++) = 0.5 * (list[2 * i + 1] + list[2 * i]);
      theta(at++) = damping < pair_damping.size() ? std::log(pair_damping[damping++])
                                                  : std::log(std::cosh(half) + 1e-9);
    }
  }
  return theta;
}

/// `smaller` with a zero and a pole (or pairs of them) added at `at`, a little apart.
VectorXd grown_theta(const VectorXd& smaller, const RootModel& old, const RootModel& model, bool real,
                     double at, double split) {
  VectorXd theta(model.size());
  Index from = 0;
  Index to = 0;
  const auto copy = [&](int count) {
    theta.segment(to, count) = smaller.segment(from, count);
    from += count;
    to += count;
  };
  if (real) {
    copy(1 + old.real_zeros);
    theta(to++) = at + split;
    copy(old.real_poles);
    theta(to++) = at - split;
  } else {
    copy(1 + old.zeros());
    theta(to++) = at;
    theta(to++) = std::log(split > 0.0 ? 0.6 : 0.9);
    copy(old.poles());
    theta(to++) = at;
    theta(to++) = std::log(split > 0.0 ? 0.9 : 0.6);
  }
  return theta;
}

/// Best first, the like ones once.
void keep_best(std::vector<SearchResult>& found, int max_kept) {
  std::ranges::stable_sort(found, {}, &SearchResult::value);
  std::vector<SearchResult> kept;
  for (SearchResult& result : found) {
    if (!std::isfinite(result.value)) continue;
    const bool known = std::ranges::any_of(kept, [&](const SearchResult& k) {
      return result.value < 1.002 * k.value && result.value > 0.998 * k.value;
    });
    if (!known) kept.push_back(std::move(result));
    if (std::ssize(kept) == max_kept) break;
  }
  found = std::move(kept);
}

void append(std::vector<SearchResult>& to, std::vector<SearchResult> more) {
  to.insert(to.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

}  // namespace

RootModel StartBuilder::make_model(int zeros, int poles, bool real, RadPerSecond reference) {
  RootModel model;
  model.reference = reference;
  if (real) {
    model.real_zeros = zeros;
    model.real_poles = poles;
  } else {
    model.zero_pairs = zeros / 2;
    model.real_zeros = zeros % 2;
    model.pole_pairs = poles / 2;
    model.real_poles = poles % 2;
  }
  return model;
}

std::vector<SearchResult> StartBuilder::try_starts(const RootModel& model,
                                                   const std::vector<VectorXd>& starts) {
  tried_ += static_cast<int>(starts.size());
  std::vector<SearchResult> out(starts.size());
  parallel_for(starts.size(), thread_count(0), [&](std::size_t i) {
    stop_if_interrupted();
    out[i] = improve_(model, starts[i]);
  });
  return out;
}

std::vector<SearchResult> StartBuilder::grow(const std::vector<SearchResult>& best, const RootModel& old,
                                             const RootModel& model) {
  const double low = std::log(settings_.low.value);
  const double high = std::log(settings_.high.value);
  std::vector<VectorXd> starts;
  for (std::size_t k = 0; k < std::min(kGrown, best.size()); ++k) {
    for (int i = 0; i < kPlaces; ++i) {
      const double at = low + (high - low) * (i + 0.5) / kPlaces;
      for (const double split : {0.15, -0.15})
        starts.push_back(grown_theta(best[k].theta, old, model, settings_.real, at, split));
    }
  }
  return try_starts(model, starts);
}

std::vector<SearchResult> StartBuilder::spread_evenly(const RootModel& model) {
  const double low = std::log(settings_.low.value);
  const double high = std::log(settings_.high.value);
  const auto even = [&](int count, double shift) {
    std::vector<double> out;
    for (int i = 0; i < count; ++i)
      out.push_back(low + (high - low) * (i + 0.5 + shift) / std::max(count, 1));
    return out;
  };
  std::vector<VectorXd> starts;
  for (const double shift : {0.2, -0.2}) {
    const Corners corners{even(model.zeros(), shift), even(model.poles(), -shift)};
    starts.push_back(theta_of(model, corners, {}, settings_.log_gain));
  }
  return try_starts(model, starts);
}

std::vector<SearchResult> StartBuilder::scatter(const RootModel& model, int count, std::mt19937_64& random) {
  std::uniform_real_distribution<double> place(std::log(settings_.low.value), std::log(settings_.high.value));
  std::uniform_real_distribution<double> log_damping(std::log(0.15), std::log(2.0));
  std::vector<VectorXd> starts;
  for (int i = 0; i < count; ++i) {
    Corners corners;
    for (int k = 0; k < model.zeros(); ++k) corners.zeros.push_back(place(random));
    for (int k = 0; k < model.poles(); ++k) corners.poles.push_back(place(random));
    std::vector<double> damping;
    for (int k = 0; k < model.zero_pairs + model.pole_pairs; ++k)
      damping.push_back(std::exp(log_damping(random)));
    starts.push_back(theta_of(model, std::move(corners), damping, settings_.log_gain));
  }
  return try_starts(model, starts);
}

std::vector<SearchResult> StartBuilder::build(int zeros, int poles, RadPerSecond reference) {
  std::mt19937_64 random(settings_.seed);
  const int excess = poles - zeros;
  // A model grows only when zeros and poles do.
  const int step = settings_.real ? 1 : 2;
  std::vector<SearchResult> best;
  RootModel old;
  for (int m = zeros % step; m <= zeros; m += step) {
    if (m + excess == 0) continue;
    const RootModel model = make_model(m, m + excess, settings_.real, reference);
    std::vector<SearchResult> grown = grow(best, old, model);
    std::vector<SearchResult> scattered = spread_evenly(model);
    const int count = m == zeros ? settings_.random : std::max(4, settings_.random / 4);
    append(scattered, scatter(model, count, random));
    // Both kinds stay in the race: which one ends better is not seen from the rms alone.
    keep_best(grown, settings_.kept);
    keep_best(scattered, settings_.kept / 2);
    best = std::move(grown);
    append(best, std::move(scattered));
    keep_best(best, settings_.kept + settings_.kept / 2);
    old = model;
  }
  return best;
}

}  // namespace bodesmith
