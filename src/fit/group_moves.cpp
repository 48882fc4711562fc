#include "fit/group_moves.hpp"

#include <algorithm>
#include <cmath>

#include "base/progress.hpp"
#include "fit/constrained_search.hpp"
#include "numeric/parallel_for.hpp"

namespace bodesmith {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

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
  std::stable_sort(found.begin(), found.end(),
                   [](const SearchResult& a, const SearchResult& b) { return a.value < b.value; });
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
