#include "fit/start_builder.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace bodesmith {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

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
  size_t damping = 0;
  std::sort(corners.zeros.begin(), corners.zeros.end());
  std::sort(corners.poles.begin(), corners.poles.end());
  for (const bool zero : {true, false}) {
    const auto& list = zero ? corners.zeros : corners.poles;
    const auto reals = static_cast<size_t>(zero ? model.real_zeros : model.real_poles);
    const auto pairs = static_cast<size_t>(zero ? model.zero_pairs : model.pole_pairs);
    for (size_t i = 0; i < reals; ++i) theta(at++) = list[2 * pairs + i];
    for (size_t i = 0; i < pairs; ++i) {
      const double half = 0.5 * (list[2 * i + 1] - list[2 * i]);
      theta(at++) = 0.5 * (list[2 * i + 1] + list[2 * i]);
      theta(at++) = damping < pair_damping.size() ? std::log(pair_damping[damping++])
                                                  : std::log(std::cosh(half) + 1e-9);
    }
  }
  return theta;
}

void keep_best(std::vector<SearchResult>& found, int most) {
  std::stable_sort(found.begin(), found.end(),
                   [](const SearchResult& a, const SearchResult& b) { return a.value < b.value; });
  std::vector<SearchResult> kept;
  for (SearchResult& result : found) {
    if (!std::isfinite(result.value)) continue;
    const bool known = std::any_of(kept.begin(), kept.end(), [&](const SearchResult& k) {
      return result.value < 1.002 * k.value && result.value > 0.998 * k.value;
    });
    if (!known) kept.push_back(std::move(result));
    if (static_cast<int>(kept.size()) == most) break;
  }
  found = std::move(kept);
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

std::vector<SearchResult> StartBuilder::build(int zeros, int poles, RadPerSecond reference) {
  const double low = std::log(settings_.low.value);
  const double high = std::log(settings_.high.value);
  std::mt19937_64 chance(settings_.seed);
  const int excess = poles - zeros;
  const int step = settings_.real ? 1 : 2;
  std::vector<SearchResult> best;
  RootModel old;
  for (int m = zeros % step; m <= zeros; m += step) {
    const int n = m + excess;
    if (n == 0) continue;
    const RootModel model = make_model(m, n, settings_.real, reference);
    std::vector<SearchResult> grown;
    std::vector<SearchResult> scattered;
    const auto try_start = [&](const VectorXd& theta, std::vector<SearchResult>& found) {
      ++tried_;
      found.push_back(improve_(model, theta));
    };
    // Grow: a new zero and pole (or pairs of them) that nearly cancel. A model grows only when both kinds do.
    constexpr int kPlaces = 11;
    for (size_t k = 0; k < std::min<size_t>(4, best.size()); ++k) {
      for (int i = 0; i < kPlaces; ++i) {
        const double at = low + (high - low) * (i + 0.5) / kPlaces;
        for (const double split : {0.15, -0.15}) {
          VectorXd theta(model.size());
          Index from = 0;
          Index to = 0;
          const auto copy = [&](int count) {
            theta.segment(to, count) = best[k].theta.segment(from, count);
            from += count;
            to += count;
          };
          if (settings_.real) {
            copy(1 + old.real_zeros);
            theta(to++) = at + split;
            copy(old.real_poles);
            theta(to++) = at - split;
          } else {
            copy(1 + old.real_zeros + 2 * old.zero_pairs);
            theta(to++) = at;
            theta(to++) = std::log(split > 0.0 ? 0.6 : 0.9);
            copy(old.real_poles + 2 * old.pole_pairs);
            theta(to++) = at;
            theta(to++) = std::log(split > 0.0 ? 0.9 : 0.6);
          }
          try_start(theta, grown);
        }
      }
    }
    // Evenly spread, interlaced both ways round.
    const auto even = [&](int count, double shift) {
      std::vector<double> out;
      for (int i = 0; i < count; ++i)
        out.push_back(low + (high - low) * (i + 0.5 + shift) / std::max(count, 1));
      return out;
    };
    for (const double shift : {0.2, -0.2}) {
      try_start(theta_of(model, {even(m, shift), even(n, -shift)}, {}, settings_.log_gain), scattered);
    }
    std::uniform_real_distribution<double> place(low, high);
    std::uniform_real_distribution<double> damping(std::log(0.15), std::log(2.0));
    const int random = m == zeros ? settings_.random : std::max(4, settings_.random / 4);
    for (int i = 0; i < random; ++i) {
      Corners corners;
      for (int k = 0; k < m; ++k) corners.zeros.push_back(place(chance));
      for (int k = 0; k < n; ++k) corners.poles.push_back(place(chance));
      std::vector<double> dampings;
      for (int k = 0; k < model.zero_pairs + model.pole_pairs; ++k)
        dampings.push_back(std::exp(damping(chance)));
      try_start(theta_of(model, std::move(corners), dampings, settings_.log_gain), scattered);
    }
    // Both kinds stay in the race: which one ends better is not seen from the rms alone.
    keep_best(grown, settings_.kept);
    keep_best(scattered, settings_.kept / 2);
    best = std::move(grown);
    best.insert(best.end(), std::make_move_iterator(scattered.begin()),
                std::make_move_iterator(scattered.end()));
    keep_best(best, settings_.kept + settings_.kept / 2);
    old = model;
  }
  return best;
}

}  // namespace bodesmith
