#include "chain/inverse.hpp"

#include <algorithm>
#include <cmath>

#include "chain/local_chain.hpp"
#include "numeric/optimisation/root.hpp"
#include "signal/time_record.hpp"

namespace bodesmith::chain {
namespace {

/// The point between low and high, where the polynomial is monotone, at which it is y or nearest to it.
double place_of(const std::vector<double>& c, double low, double high, double y) {
  return root_between([&](double x) { return polynomial_at(c, x) - y; }, low, high);
}

/// Where all real roots lie (Cauchy's bound), for coefficients without a zero at the top.
double root_bound(const std::vector<double>& c) {
  double most = 0.0;
  for (std::size_t i = 0; i + 1 < c.size(); ++i) most = std::max(most, std::abs(c[i] / c.back()));
  return 1.0 + most;
}

/// Real places where the polynomial changes its sign, rising: between those of its derivative it is monotone.
std::vector<double> sign_changes(std::vector<double> c) {
  while (!c.empty() && c.back() == 0.0) c.pop_back();
  if (c.size() < 2) return {};
  std::vector<double> derivative;
  for (std::size_t i = 1; i < c.size(); ++i) derivative.push_back(static_cast<double>(i) * c[i]);
  const double bound = root_bound(c);
  if (!std::isfinite(bound)) return {};
  std::vector<double> places{-bound};
  for (const double turn : sign_changes(derivative)) places.push_back(std::clamp(turn, -bound, bound));
  places.push_back(bound);
  std::vector<double> out;
  for (std::size_t i = 0; i + 1 < places.size(); ++i) {
    const double a = polynomial_at(c, places[i]);
    const double b = polynomial_at(c, places[i + 1]);
    if ((a < 0.0) != (b < 0.0)) out.push_back(place_of(c, places[i], places[i + 1], 0.0));
  }
  return out;
}

/// A stretch of the input on which the polynomial is monotone, and what it reaches there.
struct Piece {
  double low = 0.0;
  double high = 0.0;
  double least = 0.0;
  double most = 0.0;

  bool reaches(double y) const { return y >= least && y <= most; }
  double distance_from_zero() const {
    return low <= 0.0 && high >= 0.0 ? 0.0 : std::min(std::abs(low), std::abs(high));
  }
};

std::vector<Piece> pieces_of(const std::vector<double>& c, double least, double most) {
  std::vector<double> derivative;
  for (std::size_t i = 1; i < c.size(); ++i) derivative.push_back(static_cast<double>(i) * c[i]);
  std::vector<double> turns = sign_changes(derivative);
  // Outside the turns as far as the wanted values ask for.
  const auto outer = [&](double from, double sign) {
    double reach = 1.0 + std::abs(from);
    const double begin = polynomial_at(c, from);
    for (int i = 0; i < 200; ++i, reach *= 2.0) {
      const double there = polynomial_at(c, from + sign * reach);
      if (!std::isfinite(there)) break;
      if (there > begin ? there >= most : there <= least) return from + sign * reach;
    }
    return from + sign * reach * 0.5;
  };
  std::vector<double> ends{outer(turns.empty() ? 0.0 : turns.front(), -1.0)};
  ends.insert(ends.end(), turns.begin(), turns.end());
  ends.push_back(outer(turns.empty() ? 0.0 : turns.back(), 1.0));
  std::vector<Piece> out;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    const auto [a, b] = std::minmax({polynomial_at(c, ends[i]), polynomial_at(c, ends[i + 1])});
    out.push_back({ends[i], ends[i + 1], a, b});
  }
  return out;
}

}  // namespace

FoundInput inverse_of(const LinearKernel& kernel, const WantedOutput& wanted) {
  std::vector<double> still(kernel.order());
  equilibrium(kernel, 0.0, still.data());
  const double offset = output(kernel, 0.0, still.data());
  FoundInput out = looking_ahead(wanted, kernel.delay_s);
  if (kernel.order() == 0) {
    for (double& value : out.values) value = kernel.d == 0.0 ? 0.0 : (value - offset) / kernel.d;
    return out;
  }
  LocalGoal goal;
  goal.change = out.values;
  for (double& value : goal.change) value -= offset;
  goal.weight.assign(goal.change.size(), 1.0);
  goal.drive.assign(goal.change.size(), 0.0);
  goal.gain = slowest_gain(kernel, wanted.step_s, goal.change.size());
  goal.smoothing = wanted.smoothing;
  LocalChain chain(wanted.step_s, goal.change.size());
  chain.add(sampled(kernel, wanted.step_s));
  out.values = chain.change_for(goal);
  return out;
}

FoundInput inverse_of_polynomial(const std::vector<double>& coefficients, const WantedOutput& wanted) {
  FoundInput out;
  const auto [low, high] = std::minmax_element(wanted.values.begin(), wanted.values.end());
  const Piece* best = nullptr;
  std::size_t best_count = 0;
  const std::vector<Piece> pieces = pieces_of(coefficients, *low, *high);
  for (const Piece& piece : pieces) {
    const auto count = static_cast<std::size_t>(
        std::ranges::count_if(wanted.values, [&](double y) { return piece.reaches(y); }));
    if (best == nullptr || count > best_count ||
        (count == best_count && piece.distance_from_zero() < best->distance_from_zero())) {
      best = &piece;
      best_count = count;
    }
  }
  for (std::size_t i = 0; i < wanted.values.size(); ++i) {
    const double y = wanted.values[i];
    if (!best->reaches(y)) out.out_of_reach.push_back(i);
    out.values.push_back(place_of(coefficients, best->low, best->high, y));
  }
  return out;
}

FoundInput inverse_of(const SourceKernel& kernel, const WantedOutput& wanted) {
  FoundInput out;
  for (std::size_t i = 0; i < wanted.values.size(); ++i)
    out.values.push_back(wanted.values[i] -
                         kernel.value(wanted.start_s + wanted.step_s * static_cast<double>(i)));
  return out;
}

FoundInput looking_ahead(const WantedOutput& wanted, double lead_s) {
  return {wanted.preview ? later_by(wanted.values, -lead_s / wanted.step_s) : wanted.values, {}};
}

FoundInput inverse_of(SampledKernel& kernel, const WantedOutput& wanted) {
  FoundInput out = looking_ahead(wanted, mean_delay_s(kernel));
  const double gain = gain_at_rest(kernel);
  for (double& value : out.values) value = gain == 0.0 ? 0.0 : value / gain;
  return out;
}

double gain_at_rest(SampledKernel& kernel) {
  return kernel.reset(1.0, true);
}

double mean_delay_s(const SampledKernel& kernel) {
  return 0.5 / kernel.clock_hz() + kernel.delay_s();
}

}  // namespace bodesmith::chain
