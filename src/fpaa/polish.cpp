#include "fpaa/polish.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

namespace bodesmith::fpaa {
namespace {

/// Triples are tried among this many of the finest branches, and pairs with all after them.
constexpr std::size_t kPolishedTriples = 16;
/// Pairs are tried among this many; the coarser branches are then only looked at one by one.
constexpr std::size_t kPolishedPairs = 32;
/// Rounds for longer chains.
constexpr int kRoundsOfLongChain = 2;
/// Choices are looked at whose total gain is within the shape's error of the best for the shape, between
/// these limits (nepers).
constexpr double kMinGainWindow = 2e-4;
constexpr double kMaxGainWindow = 1e-3;
/// A round must take the cost below this share of what it was for another to follow.
constexpr double kWorthwhileRound = 0.998;
/// Improvements below this are rounding.
constexpr double kRounding = 1e-12;

/// One candidate each of two branches, and their gain together.
struct CandidatePair {
  double gain;
  std::uint32_t a, b;
};

/// A change of one branch.
struct BranchMove {
  std::size_t branch;
  std::size_t candidate;
};

class Polisher {
 public:
  Polisher(ChoiceState state, const SearchEffort& effort)
      : lists_(state.lists()), state_(std::move(state)), effort_(effort), cost_(state_.cost()) {
    const ChoiceState::Shape shape = state_.shape();
    gain_window_ = std::clamp(shape.error, kMinGainWindow, kMaxGainWindow);
    gain_target_ = state_.total_gain() - shape.log_gain;
  }

  ChoiceState run() {
    const std::size_t n = lists_.branches();
    const std::size_t paired = std::min(n, kPolishedPairs);
    const int rounds = n > kPolishedPairs ? kRoundsOfLongChain : effort_.polish_rounds;
    for (int round = 0; round < rounds; ++round) {
      const double before = cost_;
      for (std::size_t i = 0; i < n; ++i) {
        improve_single(lists_.finest_first()[i]);
        for (std::size_t j = i + 1; j < paired; ++j) improve_with_pair(i, j);
      }
      if (!(cost_ < before * kWorthwhileRound)) break;
    }
    return {lists_, state_.choice()};  // worked out anew: sheds rounding
  }

 private:
  /// The candidates [first, second) of a branch around its present choice.
  std::pair<std::size_t, std::size_t> neighbours(std::size_t branch) const {
    const std::size_t half = effort_.neighbours / 2;
    const std::size_t now = state_.choice()[branch];
    std::size_t from = now > half ? now - half : 0;
    const std::size_t to = std::min(lists_[branch].size(), from + 2 * half + 1);
    from = to > 2 * half + 1 ? to - (2 * half + 1) : 0;
    return {from, to};
  }

  void improve_single(std::size_t i) {
    std::size_t best = state_.choice()[i];
    for (std::size_t c = 0; c < lists_[i].size(); ++c) {
      state_.replace(i, c);
      if (const double cost = state_.cost(); cost < cost_ - kRounding) {
        cost_ = cost;
        best = c;
      }
    }
    state_.replace(i, best);
  }

  /// All pairs of neighbours of two branches, by their gain.
  void list_pairs(std::size_t i, std::size_t j) {
    pairs_.clear();
    const auto [from_i, to_i] = neighbours(i);
    const auto [from_j, to_j] = neighbours(j);
    for (std::size_t a = from_i; a < to_i; ++a) {
      for (std::size_t b = from_j; b < to_j; ++b) {
        pairs_.push_back({lists_[i][a].log_gain + lists_[j][b].log_gain, static_cast<std::uint32_t>(a),
                          static_cast<std::uint32_t>(b)});
      }
    }
    std::sort(pairs_.begin(), pairs_.end(), [](const CandidatePair& x, const CandidatePair& y) {
      return x.gain != y.gain ? x.gain < y.gain : x.a != y.a ? x.a < y.a : x.b < y.b;
    });
  }

  /// The branches at places `at_i` < `at_j` of finest_first() with each later one, then alone.
  void improve_with_pair(std::size_t at_i, std::size_t at_j) {
    const std::vector<std::size_t>& order = lists_.finest_first();
    const std::size_t i = order[at_i];
    const std::size_t j = order[at_j];
    list_pairs(i, j);
    const std::size_t n = lists_.branches();
    const std::size_t last = at_j < kPolishedTriples ? std::min(n, kPolishedTriples) : n;
    for (std::size_t at_k = at_j + 1; at_k < last; ++at_k) {
      const std::size_t k = order[at_k];
      const auto [from, to] = neighbours(k);
      for (std::size_t c = from; c < to; ++c) try_pairs(i, j, BranchMove{k, c});
    }
    try_pairs(i, j, std::nullopt);
  }

  /// Every listed pair of branches i and j whose gain suits, together with a change of a third one.
  void try_pairs(std::size_t i, std::size_t j, const std::optional<BranchMove>& third) {
    double rest = state_.total_gain() - state_.chosen(i).log_gain - state_.chosen(j).log_gain;
    if (third) {
      rest += lists_[third->branch][third->candidate].log_gain - state_.chosen(third->branch).log_gain;
    }
    // A gain error counts fully at low frequency, where every branch is its C0.
    const double window = std::min(gain_window_, cost_);
    const double wanted = gain_target_ - rest;
    auto at = std::lower_bound(pairs_.begin(), pairs_.end(), wanted - window,
                               [](const CandidatePair& x, double gain) { return x.gain < gain; });
    for (; at != pairs_.end() && at->gain <= wanted + window; ++at) {
      if (is_promising({i, at->a}, {j, at->b}, third)) try_moves({i, at->a}, {j, at->b}, third);
    }
  }

  /// Whether the residual alone would stay below the present cost. A few points first: most fail at once.
  bool is_promising(BranchMove first, BranchMove second, const std::optional<BranchMove>& third) const {
    const Candidate& ai = lists_[first.branch][first.candidate];
    const Candidate& bj = lists_[second.branch][second.candidate];
    const Candidate& oi = state_.chosen(first.branch);
    const Candidate& oj = state_.chosen(second.branch);
    const Candidate* ck = third ? &lists_[third->branch][third->candidate] : nullptr;
    const Candidate* ok = third ? &state_.chosen(third->branch) : nullptr;
    const std::vector<double>& res_re = state_.re();
    const std::vector<double>& res_im = state_.im();
    const double limit = cost_ * cost_;
    const auto fails = [&](std::size_t m) {
      double re = res_re[m] + ai.re[m] + bj.re[m] - oi.re[m] - oj.re[m];
      double im = res_im[m] + ai.im[m] + bj.im[m] - oi.im[m] - oj.im[m];
      if (ck != nullptr) {
        re += ck->re[m] - ok->re[m];
        im += ck->im[m] - ok->im[m];
      }
      return re * re + im * im >= limit;
    };
    const std::size_t points = res_re.size();
    if (fails(points - 1) || fails(points / 2) || fails(0)) return false;
    for (std::size_t m = 1; m + 1 < points; ++m) {
      if (fails(m)) return false;
    }
    return true;
  }

  /// Keeps the moves when they lower the cost.
  void try_moves(BranchMove first, BranchMove second, const std::optional<BranchMove>& third) {
    const auto exchange = [&](BranchMove& move) {
      const std::size_t old = state_.choice()[move.branch];
      state_.replace(move.branch, move.candidate);
      move.candidate = old;
    };
    std::optional<BranchMove> other = third;
    exchange(first);
    exchange(second);
    if (other) exchange(*other);
    if (const double cost = state_.cost(); cost < cost_ - kRounding) {
      cost_ = cost;
      return;
    }
    exchange(first);
    exchange(second);
    if (other) exchange(*other);
  }

  const CandidateLists& lists_;
  ChoiceState state_;
  SearchEffort effort_;
  double cost_;
  double gain_window_ = 0.0;
  double gain_target_ = 0.0;  ///< total gain that is best for the shape at hand
  std::vector<CandidatePair> pairs_;
};

}  // namespace

ChoiceState polished(ChoiceState state, const SearchEffort& effort) {
  return Polisher(std::move(state), effort).run();
}

}  // namespace bodesmith::fpaa
