#include "fpaa/chain_search.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numeric>
#include <span>

#include "fpaa/beam.hpp"
#include "fpaa/candidates.hpp"
#include "fpaa/choice_state.hpp"
#include "fpaa/polish.hpp"

namespace bodesmith::fpaa {
namespace {

/// A gain error that polishing surely removes, nepers.
constexpr double kGainSlack = 0.02;
/// With two branches (one CAM) every pair of candidates is tried, of this many.
constexpr std::size_t kCandidatesOfOneCam = 800;
/// How lightly the beam binds open branches to their nominal corners: each of these in turn when its results
/// are polished, the one in between when only shapes are judged.
constexpr double kPolishedWeights[] = {1e-4, 1e-3};
constexpr double kShapeWeights[] = {3e-4};
/// With more branches than this only the best of the beam is polished.
constexpr std::size_t kBranchesOfLongChain = 32;

/// A choice and what it is worth.
struct ScoredChoice {
  Choice choice;
  double score = std::numeric_limits<double>::infinity();
};

/// One CAM by itself, to be finished.
bool is_exhaustive(const ChainProblem& problem, const SearchEffort& effort) {
  return problem.branches.size() == 2 && effort.polished > 0;
}

/// The best pair of candidates of two branches.
Choice best_of_all(const CandidateLists& lists) {
  const ChainProblem& p = lists.problem();
  Choice best{0, 0};
  double min_error = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < lists[0].size(); ++a) {
    for (std::size_t b = 0; b < lists[1].size(); ++b) {
      const Candidate& x = lists[0][a];
      const Candidate& y = lists[1][b];
      double worst = 0.0;
      // Exact: |exp(r) - 1| of the whole residual, which may be large here.
      for (std::size_t k = 0; k < lists.points() && worst < min_error; ++k) {
        const double re = -p.log_gain + x.re[k] + y.re[k] + (p.others.empty() ? 0.0 : p.others[k].real());
        const double im = x.im[k] + y.im[k] + (p.others.empty() ? 0.0 : p.others[k].imag());
        const double size = std::exp(re);
        worst = std::max(worst, size * size - 2.0 * size * std::cos(im) + 1.0);
      }
      if (worst < min_error) {
        min_error = worst;
        best = {a, b};
      }
    }
  }
  return best;
}

/// The best few by their worst error with the gain free.
std::vector<ChoiceState> best_by_shape(const CandidateLists& lists, const std::vector<Choice>& choices,
                                       std::size_t few) {
  std::vector<double> errors;
  for (const Choice& choice : choices) errors.push_back(ChoiceState(lists, choice).shape().error);
  std::vector<std::size_t> rank(choices.size());
  std::iota(rank.begin(), rank.end(), std::size_t{0});
  std::stable_sort(rank.begin(), rank.end(),
                   [&](std::size_t a, std::size_t b) { return errors[a] < errors[b]; });
  std::vector<ChoiceState> out;
  for (std::size_t r = 0; r < rank.size() && r < few; ++r) out.emplace_back(lists, choices[rank[r]]);
  return out;
}

ScoredChoice finish(ChoiceState state, const SearchEffort& effort) {
  if (effort.polished == 0) {
    return {state.choice(), state.shape().error + std::max(0.0, state.gain_out_of_reach() - kGainSlack)};
  }
  state = polished(std::move(state), effort);
  return {state.choice(), state.cost()};
}

ScoredChoice search_by_beam(const CandidateLists& lists, const SearchEffort& effort) {
  std::span<const double> weights = kShapeWeights;
  if (effort.polished > 0) weights = kPolishedWeights;
  const std::size_t few =
      lists.branches() > kBranchesOfLongChain ? 1 : std::max(std::size_t{1}, effort.polished);
  ScoredChoice best;
  for (const double weight : weights) {
    for (ChoiceState& start : best_by_shape(lists, beam_search(lists, weight, effort.beam), few)) {
      ScoredChoice found = finish(std::move(start), effort);
      if (found.score < best.score) best = std::move(found);
    }
  }
  return best;
}

}  // namespace

ChainSolution search_chain(const ChainProblem& problem, const SearchEffort& effort) {
  const bool exhaustive = is_exhaustive(problem, effort);
  const CandidateLists lists(problem, exhaustive ? kCandidatesOfOneCam : effort.candidates);
  ChainSolution out;
  out.unreachable = lists.unreachable();
  if (!out.made()) return out;
  const ScoredChoice best =
      exhaustive ? ScoredChoice{best_of_all(lists), 0.0} : search_by_beam(lists, effort);
  const ChoiceState state(lists, best.choice);
  for (std::size_t i = 0; i < lists.branches(); ++i) out.values.push_back(state.chosen(i).value);
  out.max_complex_error = state.exact_error();
  out.shape_error = effort.polished > 0 ? state.shape().error : best.score;
  out.gain_error = state.total_gain() - problem.log_gain;
  out.spread = state.spread();
  return out;
}

}  // namespace bodesmith::fpaa
