#include "fpaa/topology_search.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/progress.hpp"
#include "fpaa/error_budget.hpp"
#include "fpaa/network_plan.hpp"
#include "fpaa/topology_candidates.hpp"
#include "fpaa/topology_target.hpp"
#include "numeric/parallel_for.hpp"

namespace bodesmith::fpaa {
namespace {

/// How much of the spread by mismatch counts in the last polish, where the error itself comes first.
constexpr double kPolishShare = 0.05;
constexpr double kGoodEnough = 3e-3;  ///< an error in the band that needs no more care
/// Of the candidates: how many are made whole again with more care, the best as they are and those that were
/// best before their capacitors were whole.
constexpr std::size_t kRefinedBest = 4;
constexpr std::size_t kRefinedExact = 2;
constexpr int kPolishRounds = 40;
constexpr int kSearchThreads = 2;
/// Each further chip costs this share of the error.
constexpr double kChipCost = 0.15;
/// With paths that sample within the band and an error above the first, all clocks above the second times the band
/// are tried too.
constexpr double kWorthQuicker = 8e-3;
constexpr double kQuicker = 2.2;

/// Those that fit on the board: the best as they are, and the best before their capacitors were whole.
std::vector<TopologyCandidate> worth_refining(std::vector<TopologyCandidate> found, const Board& board) {
  std::vector<TopologyCandidate> out;
  std::vector<TopologyCandidate> rest;
  for (TopologyCandidate& candidate : found) {
    if (out.size() >= kRefinedBest) {
      rest.push_back(std::move(candidate));
      continue;
    }
    if (refusal_of(plan_of_network(candidate.network, board)) == nullptr) out.push_back(std::move(candidate));
  }
  std::stable_sort(rest.begin(), rest.end(), [](const TopologyCandidate& a, const TopologyCandidate& b) {
    return a.exact_error < b.exact_error;
  });
  for (TopologyCandidate& candidate : rest) {
    if (out.size() >= kRefinedBest + kRefinedExact) break;
    if (refusal_of(plan_of_network(candidate.network, board)) == nullptr) out.push_back(std::move(candidate));
  }
  return out;
}

/// kT/C noise in the band as a share of a full-scale sine, times its weight.
double noise_share(const Plan& plan, Band band, const NoiseModel& noise, const Board& board) {
  if (!(noise.weight > 0.0)) return 0.0;
  const double rms = 1e-6 * noise.microvolts(noise_in_band_kt_per_cu(plan, band));
  return noise.weight * rms * std::numbers::sqrt2 / board.full_scale_v;
}

/// A candidate's rank with noise and further chips counted.
double rank_on_board(const TopologyCandidate& candidate, const Plan& plan, Band band, const NoiseModel& noise,
                     const Board& board) {
  const double chips = static_cast<double>(plan.chips.size());
  return (candidate.rank() + noise_share(plan, band, noise, board)) * (1.0 + kChipCost * (chips - 1.0));
}

/// The one with the smallest rank among those that fit on the board; null: none does.
TopologyCandidate* best_on_board(std::vector<TopologyCandidate>& found, Band band, const NoiseModel& noise,
                                 const Board& board, std::optional<Refusal>& why_not) {
  TopologyCandidate* best = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (TopologyCandidate& candidate : found) {
    if (candidate.rank() >= least) continue;
    const Outcome<Plan> plan = plan_of_network(candidate.network, board);
    if (const Refusal* refusal = refusal_of(plan)) {
      if (!why_not) why_not = *refusal;
      continue;
    }
    const double rank = rank_on_board(candidate, std::get<Plan>(plan), band, noise, board);
    if (rank >= least) continue;
    least = rank;
    best = &candidate;
  }
  return best;
}

/// Made whole once more with several partly whole networks side by side, and polished by pairs; keeps whichever
/// is better.
void refine(TopologyCandidate& candidate, const Sections& sections, Band band, const PlanOptions& options,
            const Board& board) {
  const std::int64_t divisor = candidate.exact.stages.back().divisor;
  const NetworkTarget target = with_clocks_seen(
      network_target(sections, band, board.master_clock.value / static_cast<double>(divisor), board),
      clocked_poles(candidate.exact, board.master_clock.value), sections);
  const NetworkResponse response(target);
  const MismatchModel& mismatch = options.assumptions.mismatch;
  std::vector<Network> tries{candidate.network};
  Network again = candidate.exact;
  if (round_network(again, response, {.networks = 2, .choices = 3})) tries.push_back(std::move(again));
  for (Network& network : tries) {
    polish_network(network, response, mismatch, 0.0, 2);
    polish_pairs(network, response, mismatch, kPolishShare, kPolishRounds);
    const NetworkTarget closer = seen_closer(target, network, sections);
    const NetworkScore score = network_score(network, NetworkResponse(closer), mismatch, kMismatchShare);
    if (!(score.total < candidate.score.total)) continue;
    candidate.clipping = clipping_of(network, response);
    candidate.network = std::move(network);
    candidate.score = score;
  }
}

Outcome<SearchedNetwork> search_once(const Sections& sections, Band band, const PlanOptions& options,
                                     const Board& board) {
  std::vector<TopologyCandidate> found;
  {
    const Progress progress("topologies");
    found = topology_candidates(sections, band, options, board);
  }
  if (found.empty()) return Refusal{"no topology makes these sections with the board's capacitors"};
  std::optional<Refusal> why_not;
  TopologyCandidate* best = best_on_board(found, band, options.assumptions.noise, board, why_not);
  if (best == nullptr) return *why_not;
  std::vector<TopologyCandidate> chosen;
  if (best->score.in_band > kGoodEnough) {
    chosen = worth_refining(found, board);
    Progress progress("capacitors");
    std::atomic<std::size_t> done = 0;
    parallel_for(chosen.size(), kSearchThreads, [&](std::size_t i) {
      refine(chosen[i], sections, band, options, board);
      progress.at(static_cast<double>(++done) / static_cast<double>(chosen.size()));
    });
    best = best_on_board(chosen, band, options.assumptions.noise, board, why_not);
    if (best == nullptr) return *why_not;
  } else {
    const std::int64_t divisor = best->network.stages.back().divisor;
    const NetworkTarget target =
        network_target(sections, band, board.master_clock.value / static_cast<double>(divisor), board);
    const NetworkResponse response(target);
    const MismatchModel& mismatch = options.assumptions.mismatch;
    polish_network(best->network, response, mismatch, kMismatchShare, 2);
    best->score = network_score(best->network, response, mismatch, kMismatchShare);
  }
  Plan plan = value_or_throw(plan_of_network(best->network, board));
  const double rank = rank_on_board(*best, plan, band, options.assumptions.noise, board);
  return SearchedNetwork{std::move(best->network), best->score, best->topology,
                         std::move(plan),          rank,        best->beats};
}

}  // namespace

Outcome<SearchedNetwork> search_topology(const Sections& sections, Band band, const PlanOptions& options,
                                         const Board& board) {
  Outcome<SearchedNetwork> out = search_once(sections, band, options, board);
  if (options.lowest_clock || refusal_of(out) != nullptr) return out;
  const SearchedNetwork& first = std::get<SearchedNetwork>(out);
  if (!first.beats || first.score.in_band < kWorthQuicker) return out;
  PlanOptions quicker = options;
  quicker.lowest_clock = Hertz{kQuicker * band.to.value};
  Outcome<SearchedNetwork> other = search_once(sections, band, quicker, board);
  if (refusal_of(other) == nullptr && std::get<SearchedNetwork>(other).rank < first.rank) return other;
  return out;
}

}  // namespace bodesmith::fpaa
