#include "fit/direct/group_moves.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/progress.hpp"
#include "fit/direct/constrained_search.hpp"
#include "numeric/parallel_for.hpp"

namespace bodesmith {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

double max_weighted_error_db(const RootModel::Roots& roots, const CurveTarget& target) {
  double worst = 0.0;
  for (std::size_t i = 0; i < target.frequency.size(); ++i) {
    const Complex s(0.0, target.frequency[i].value);
    double log_gain = std::log(roots.gain);
    for (const auto& z : roots.zeros) log_gain += std::log(std::abs(s - z));
    for (const auto& p : roots.poles) log_gain -= std::log(std::abs(s - p));
    worst = std::max(worst, target.weight[i] * std::abs(log_gain - target.log_gain[i]));
  }
  return kDecibelPerNeper * worst;
}

/// A real zero and a real pole, or the upper ones of two pairs, within a hundredth of each other.
bool nearly_cancel(Complex zero, Complex pole) {
  if (zero.imag() < 0.0 || pole.imag() < 0.0 || (zero.imag() == 0.0) != (pole.imag() == 0.0)) return false;
  return std::abs(zero - pole) <= 1e-2 * std::abs(pole);
}

/// Without zero z and pole p, and without their conjugates, which stand right behind them.
RootModel::Roots without(RootModel::Roots roots, std::size_t z, std::size_t p) {
  const std::ptrdiff_t count = roots.zeros[z].imag() == 0.0 ? 1 : 2;
  const auto zero = roots.zeros.begin() + static_cast<std::ptrdiff_t>(z);
  const auto pole = roots.poles.begin() + static_cast<std::ptrdiff_t>(p);
  roots.zeros.erase(zero, zero + count);
  roots.poles.erase(pole, pole + count);
  return roots;
}

/// The roots without the first cancelling ones that do not matter; nothing when there are none.
std::optional<RootModel::Roots> drop_one(const RootModel::Roots& roots, const CurveTarget& target,
                                         double allowed_db) {
  for (std::size_t z = 0; z < roots.zeros.size(); ++z) {
    for (std::size_t p = 0; p < roots.poles.size(); ++p) {
      if (!nearly_cancel(roots.zeros[z], roots.poles[p])) continue;
      RootModel::Roots fewer = without(roots, z, p);
      if (!fewer.poles.empty() && max_weighted_error_db(fewer, target) <= allowed_db) return fewer;
    }
  }
  return std::nullopt;
}

double allowed_error_db(const RootModel::Roots& roots, const CurveTarget& target, double value_db) {
  return std::max(1.001 * std::max(value_db, max_weighted_error_db(roots, target)), 1e-5);
}

/// The roots without the highest zero (or pair), its gain at low frequencies kept.
RootModel::Roots without_highest_zero(RootModel::Roots roots) {
  const auto magnitude = [](const auto& a, const auto& b) { return std::abs(a) < std::abs(b); };
  for (int count = std::ranges::max_element(roots.zeros, magnitude)->imag() == 0.0 ? 1 : 2; count > 0;
       --count) {
    const auto highest = std::ranges::max_element(roots.zeros, magnitude);
    roots.gain *= std::abs(*highest);
    roots.zeros.erase(highest);
  }
  return roots;
}

constexpr int kRounds = 3;
constexpr int kMovePlaces = 9;        ///< evenly over log frequency
constexpr std::size_t kRefined = 6;   ///< the best different ones of a round
constexpr double kGoodEnough = 1e-6;  ///< Np: nothing left to gain
constexpr double kWorthAnotherRound = 0.995;

/// The zero (of those from `first_zero` on, `width` numbers each) nearest in frequency to the pole.
Index nearest_zero(const VectorXd& theta, Index first_zero, int zeros, Index width, Index pole) {
  Index nearest = first_zero;
  for (int z = 1; z < zeros; ++z) {
    const Index here = first_zero + width * z;
    if (std::abs(theta(here) - theta(pole)) < std::abs(theta(nearest) - theta(pole))) nearest = here;
  }
  return nearest;
}

}  // namespace

int drop_distant_zeros(RootModel::Roots& roots, const CurveTarget& target, double value_db) {
  const double allowed_db = allowed_error_db(roots, target, value_db);
  const double highest = target.frequency.back().value;
  const std::size_t before = roots.zeros.size();
  while (!roots.zeros.empty()) {
    RootModel::Roots fewer = without_highest_zero(roots);
    const bool distant = std::ranges::any_of(roots.zeros, [&](auto z) { return std::abs(z) > highest; });
    if (!distant || max_weighted_error_db(fewer, target) > allowed_db) break;
    roots = std::move(fewer);
  }
  return static_cast<int>(before - roots.zeros.size());
}

int move_zeros_to_origin(RootModel::Roots& roots, const CurveTarget& target, double value_db) {
  const double allowed_db = allowed_error_db(roots, target, value_db);
  const double lowest = target.frequency.front().value;
  int moved = 0;
  for (std::size_t i = 0; i < roots.zeros.size();) {
    const std::size_t count = roots.zeros[i].imag() == 0.0 ? 1 : 2;
    const double corner = std::abs(roots.zeros[i]);
    RootModel::Roots there = roots;
    std::fill_n(there.zeros.begin() + static_cast<std::ptrdiff_t>(i), count, 0.0);
    i += count;
    if (!(corner > 0.0 && corner < lowest) || max_weighted_error_db(there, target) > allowed_db) continue;
    roots = std::move(there);
    moved += static_cast<int>(count);
  }
  return moved;
}

int drop_cancelling(RootModel::Roots& roots, const CurveTarget& target, double value_db) {
  const double allowed_db = allowed_error_db(roots, target, value_db);
  const std::size_t before = roots.poles.size();
  while (auto fewer = drop_one(roots, target, allowed_db)) roots = std::move(*fewer);
  return static_cast<int>(before - roots.poles.size());
}

GroupMoves::GroupMoves(const RootModel& model, const RootLimits& limits,
                       const StartBuilder::Settings& settings, const CurveTarget& screening,
                       const CurveTarget& target, bool least_squares)
    : model_(model),
      limits_(limits),
      settings_(settings),
      screening_(screening),
      target_(target),
      least_squares_(least_squares) {}

SearchResult GroupMoves::improve(SearchResult best) {
  for (int round = 0; round < kRounds && best.value > kGoodEnough; ++round) {
    std::vector<SearchResult> found;
    screen_moves(best, false, found);
    screen_moves(best, true, found);
    const double before = best.value;
    best = refine(std::move(found), std::move(best));
    if (best.value > kWorthAnotherRound * before) break;
  }
  return best;
}

void GroupMoves::screen_moves(const SearchResult& from, bool pairs, std::vector<SearchResult>& found) {
  const double low = std::log(settings_.low.value);
  const double high = std::log(settings_.high.value);
  const Index first_zero = pairs ? model_.first_zero_pair() : model_.first_real_zero();
  const Index first_pole = pairs ? model_.first_pole_pair() : model_.first_real_pole();
  const int zeros = pairs ? model_.zero_pairs : model_.real_zeros;
  const int poles = pairs ? model_.pole_pairs : model_.real_poles;
  const Index width = pairs ? 2 : 1;
  if (zeros == 0) return;
  std::vector<VectorXd> starts;
  for (int p = 0; p < poles; ++p) {
    const Index pole = first_pole + width * p;
    const Index zero = nearest_zero(from.theta, first_zero, zeros, width, pole);
    for (int i = 0; i < kMovePlaces; ++i) {
      for (const double split : {0.15, -0.15}) {
        VectorXd theta = from.theta;
        const double at = low + (high - low) * (i + 0.5) / kMovePlaces;
        theta(zero) = pairs ? at : at + split;
        theta(pole) = pairs ? at : at - split;
        if (pairs) {
          theta(zero + 1) = std::log(split > 0.0 ? 0.5 : 0.8);
          theta(pole + 1) = std::log(split > 0.0 ? 0.8 : 0.5);
        }
        starts.push_back(std::move(theta));
      }
    }
  }
  tried_ += static_cast<int>(starts.size());
  // Dense curves have one valley where few points have a flat.
  const int iterations = screening_.frequency.size() >= 100 ? 15 : 30;
  const std::size_t before = found.size();
  found.resize(before + starts.size());
  parallel_for(starts.size(), thread_count(0), [&](std::size_t i) {
    stop_if_interrupted();
    found[before + i] = search_least_squares(model_, screening_, limits_, starts[i], iterations);
  });
}

SearchResult GroupMoves::refine(std::vector<SearchResult> found, SearchResult best) const {
  std::ranges::stable_sort(found, {}, &SearchResult::value);
  double last = -1.0;
  std::size_t refined = 0;
  for (const SearchResult& start : found) {
    if (refined == kRefined) break;
    if (start.value < 1.002 * last) continue;  // the same valley
    last = start.value;
    ++refined;
    SearchResult result = search_constrained(model_, target_, limits_, start.theta, least_squares_, 60);
    if (result.value < best.value) best = std::move(result);
  }
  return best;
}

}  // namespace bodesmith
