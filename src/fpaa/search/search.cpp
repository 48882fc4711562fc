#include "fpaa/search/search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>

#include "base/progress.hpp"
#include "base/text.hpp"
#include "fpaa/plan/switched_board.hpp"
#include "fpaa/search/chain.hpp"
#include "fpaa/search/design.hpp"
#include "fpaa/search/whole_capacitors.hpp"
#include "numeric/parallel_for.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr int kSearchThreads = 2;
/// No clock above this: half a period is then 250 ns, in which a handful of op-amps of some MHz one behind the other have to
/// settle (their bandwidth is not public).
constexpr double kHighestClockHz = 2e6;
/// Op-amps of all chains that are fitted (quickly so many) and that are made whole; chains that are tried at other clocks and made whole with more care.
constexpr int kFittedOpamps = 400;
constexpr int kQuickOpamps = 40;
constexpr std::size_t kMovedChains = 6;
constexpr std::size_t kMoveRounds = 12;
constexpr int kWholeOpamps = 240;
constexpr std::size_t kRefined = 6;
/// Candidates are made whole so many at a time: by the best one so far the next are left out.
constexpr std::size_t kWave = 4;
/// A quick fit ranks no worse than this times what the closer one does (19 of 20 designs of the table: 1.4).
constexpr double kQuickFitOff = 1.4;
/// Ways to share the roots out (of the best chains) in which lowest and highest stages are joined.
constexpr std::size_t kJoinedSharings = 3;
constexpr int kQuickPairs = 8;
constexpr int kPairs = 60;
/// One clock for all: from the highest that every corner reaches down in these steps to this many times the band.
constexpr double kClockStep = 0.65;
constexpr double kLeastOverBand = 2.2;
/// A clock is moved for at least this share of the rank.
constexpr double kWorthMoving = 0.99;
struct Candidate {
  std::vector<StageRoots> stages;
  SharingOptions sharing;
  ChainClocks clocks;
  int gains = 0;
  std::optional<Design> design;
  std::int64_t divisor = 1;
  std::vector<int> halvings;
  Design exact;        ///< before its capacitors were whole
  double bound = 0.0;  ///< what that ranks with full banks
  DesignScore score;
  bool vendor = false;
  double missing = 0.0;  ///< of what is wanted of a plan (DesignScore::missing), once capacitors are whole
  double rank() const { return score.rank(design->opamps(), vendor); }
  std::pair<int, double> place() const { return score.place(missing, design->opamps(), vendor); }
};

bool is_vendor(const Design& design) {
  return std::ranges::all_of(design.stages, [](const DesignStage& s) { return s.is_vendors(); });
}

/// What whole capacitors could come to at best: each group as large as its bank; what does not come to half a unit is left out, or is
/// one where the stage needs it.
Design with_full_banks(Design design) {
  for (DesignStage& stage : design.stages) {
    const DesignStage exact = stage;
    for (const std::vector<std::size_t>& group : scale_groups(stage)) {
      double by = 1e300;
      for (const std::size_t i : group) {
        if (stage.c[i] > 0.0) by = std::min(by, stage.largest_units(i) / stage.c[i]);
      }
      for (const std::size_t i : group) stage.c[i] *= by;
    }
    for (std::size_t i = 0; i < stage.c.size(); ++i) {
      if (!(stage.c[i] > 0.0) || stage.c[i] >= 0.5) continue;
      stage.c[i] = exact.may_be_left_out(i) ? 0.0 : 1.0;
    }
  }
  return design;
}

/// A stage that came in to invert and was fitted like any other is one of pole and zero: a gain is what its pole and zero cancel in.
void name_by_use(Design& design) {
  for (std::size_t s = 0; s < design.stages.size(); ++s) {
    DesignStage& stage = design.stages[s];
    const bool is_gain =
        stage.is_first() && stage.from.size() == 1 && stage.c[0] * stage.c[3] == stage.c[1] * stage.c[2];
    stage.name = fmt::format("{}{}", is_gain ? "Gain" : "Stage", s + 1);
  }
}

class ChainSearch {
 public:
  ChainSearch(const Sections& sections, Band band, const PlanOptions& options, const Board& board)
      : sections_(sections),
        options_(options),
        board_(board),
        target_(design_target(sections, band, 10.0, board)),
        fine_(design_target(sections, band, 24.0, board)) {}

  Outcome<std::vector<FoundPlan>> run() {
    if (options_.clock) {
      const auto clock = find_clock(board_, *options_.clock);
      if (!clock) {
        return Refusal{fmt::format("no chip clock is {} Hz, the nearest is {} Hz",
                                   rounded_text(options_.clock->value, 9),
                                   rounded_text(nearest_clock(board_, *options_.clock).frequency.value, 9))};
      }
      given_ = std::int64_t{clock->system_divisor} * clock->divisor;
    }
    std::vector<Candidate> found = searched(candidates());
    if (found.empty()) return why_not_.value_or(nothing());
    if (!options_.quick) {
      for (Candidate& joined : searched(joined_candidates(found))) found.push_back(std::move(joined));
    }
    sort_by_rank(found);
    std::vector<FoundPlan> out;
    for (const Candidate* c : unbeaten(found)) {
      Design design = *c->design;
      name_by_use(design);
      out.push_back({value_or_throw(plan_of_design(design, board_)), c->vendor});
      out.back().plan.topology = c->vendor ? "chain" : "cascade";
    }
    return out;
  }

 private:
  Refusal nothing() const {
    std::string at = "no chain of the board's stages makes these sections";
    if (options_.lowest_clock)
      at += fmt::format(" at clocks of {} Hz and more", rounded_text(options_.lowest_clock->value));
    if (options_.clock) {
      at = fmt::format(
          "no chain of AnadigmDesigner2's CAMs makes these sections at a clock of {} Hz, expected another clock (or "
          "none: it is searched then)",
          rounded_text(options_.clock->value));
    } else if (options_.topology == PlanOptions::Topology::bilinear) {
      at =
          "no chain of FilterBilinear at one clock on one chip makes these sections (real poles and zeros, as many as the chip's "
          "op-amps), expected the topology chain or auto";
    } else if (options_.topology == PlanOptions::Topology::chain) {
      at =
          "no chain of AnadigmDesigner2's CAMs makes these sections (no zeros in the right half plane, complex ones only at 0), "
          "expected the topology auto";
    }
    return {at};
  }

  /// The best of all designs with whole capacitors, and those that no other one beats in both, error and input.
  std::vector<const Candidate*> unbeaten(const std::vector<Candidate>& found) const {
    constexpr double kLess = 0.95;  // what the search's 300 boards tell is known to some 5 %
    std::vector<const Candidate*> all;
    for (const Candidate& c : found) all.push_back(&c);
    std::ranges::stable_sort(
        all, [](const Candidate* a, const Candidate* b) { return a->score.input > b->score.input; });
    std::vector<const Candidate*> out{&found.front()};
    double least = std::numeric_limits<double>::infinity();
    for (const Candidate* c : all) {
      const double error = std::hypot(c->score.p95, c->score.noise);
      if (error < kLess * least && c != out.front() && !options_.quick) out.push_back(c);
      least = std::min(least, error);
    }
    return out;
  }

  /// From chains as they come to the best of them with whole capacitors; empty where none fits on the board.
  std::vector<Candidate> searched(std::vector<Candidate> list) {
    improve(list, "chains", [&](Candidate& c) { return fitted(c, target_, 10, 1); });
    keep_placeable(list, options_.quick ? kQuickOpamps : kFittedOpamps);
    improve(list, "chains, closer", [&](Candidate& c) { return fitted(c, target_, 25, 2); });
    if (options_.quick) {
      make_all_whole(list);
      return list;
    }
    if (!given_ && options_.topology != PlanOptions::Topology::bilinear) move_clocks(list);
    keep_placeable(list, kWholeOpamps);
    make_all_whole(list);
    std::vector<Candidate> refined;
    for (const Candidate& c : list) {
      if (refined.size() < kRefined && (refined.empty() || may_win(c.bound))) refined.push_back(c);
    }
    improve(refined, "capacitors, closer", [&](Candidate& c) { return refine(c); });
    list.insert(list.end(), std::make_move_iterator(refined.begin()), std::make_move_iterator(refined.end()));
    sort_by_rank(list);
    return list;
  }

  std::vector<Candidate> candidates() const {
    std::vector<Candidate> out;
    Candidate c = first_candidate();
    for (const bool nearest : {false, true}) {
      c.sharing.nearest_zeros = nearest;
      for (std::size_t left_out = 0;; ++left_out) {
        c.sharing.left_out = left_out;
        const std::vector<StageRoots> stages = shared_roots(sections_, c.sharing);
        if (stages.empty()) break;
        add_clocks(out, c, stages);
        if (given_) break;  // who gives the clock is given every root
      }
    }
    return out;
  }

  /// The best ones' roots with their lowest and highest stages joined.
  std::vector<Candidate> joined_candidates(const std::vector<Candidate>& best) const {
    std::vector<Candidate> out;
    std::vector<SharingOptions> tried;
    for (const Candidate& from : best) {
      if (vendor_only() || tried.size() == kJoinedSharings) break;
      const auto alike = [&](const SharingOptions& other) {
        return other.left_out == from.sharing.left_out && other.nearest_zeros == from.sharing.nearest_zeros;
      };
      if (std::ranges::any_of(tried, alike)) continue;
      tried.push_back(from.sharing);
      Candidate c = first_candidate();
      c.sharing.left_out = from.sharing.left_out;
      c.sharing.nearest_zeros = from.sharing.nearest_zeros;
      for (c.sharing.joined = 1;; ++c.sharing.joined) {
        const std::vector<StageRoots> stages = shared_roots(sections_, c.sharing);
        if (stages.empty()) break;
        add_clocks(out, c, stages);
      }
    }
    return out;
  }

  bool vendor_only() const { return options_.topology != PlanOptions::Topology::automatic || options_.clock; }
  /// What was asked for.
  bool is_allowed(const Candidate& c) const {
    if (options_.topology == PlanOptions::Topology::bilinear) {
      const std::vector<DesignStage>& stages = c.design->stages;
      return static_cast<int>(stages.size()) <= kCabs * kOpAmps && c.vendor &&
             std::ranges::all_of(stages, [](const DesignStage& s) { return s.is_first(); });
    }
    return c.vendor || !vendor_only();
  }

  Candidate first_candidate() const {
    Candidate c;
    c.clocks.lowest = options_.lowest_clock.value_or(Hertz{board_.master_clock.value / 260100.0});
    c.clocks.highest = Hertz{kHighestClockHz};
    c.sharing.lowest_clock_hz = c.clocks.lowest.value;
    c.sharing.low_zero = target_.band.from.value * 2.0 * std::numbers::pi / 300.0;
    c.sharing.far_zero = 50.0 * 2.0 * std::numbers::pi * target_.band.to.value;
    return c;
  }

  void add_clocks(std::vector<Candidate>& out, Candidate c, const std::vector<StageRoots>& stages) const {
    if (given_) {
      c.clocks.one = given_;
      add_gains(out, c, stages);
      return;
    }
    double reach = kHighestClockHz;
    for (const StageRoots& stage : stages) reach = std::min(reach, stage.highest_clock_hz());
    for (double clock = reach; clock > kLeastOverBand * target_.band.to.value; clock *= kClockStep) {
      c.clocks.one = fastest_divisor(target_.master_hz, clock);
      add_gains(out, c, stages);
    }
    if (options_.topology == PlanOptions::Topology::bilinear) return;
    c.clocks.one.reset();
    for (const double over_corner : {12.0, 30.0, 80.0, 200.0}) {
      for (const double over_band : {0.0, 0.3, 1.0, 3.0, 8.0, 25.0, 80.0, 200.0}) {
        c.clocks.over_corner = over_corner;
        c.clocks.over_band = over_band;
        for (const double following : {1.0, 0.125}) {
          c.clocks.following = following;
          add_gains(out, c, stages);
        }
      }
    }
  }

  /// As many stages that only invert as the sign takes, and two more.
  void add_gains(std::vector<Candidate>& out, Candidate c, const std::vector<StageRoots>& stages) const {
    for (const int gains : {0, 1, 2, 3}) {
      c.gains = gains;
      c.stages = stages;
      if (!made(c) || same_as_one(out, *c.design)) continue;
      c.vendor = is_vendor(*c.design);
      if (!is_allowed(c)) continue;
      out.push_back(c);
    }
  }

  /// A design whose capacitors come to `bound` before they are whole. While what is wanted of a plan was not found together all may,
  /// for the curve of what can be had.
  bool may_win(double bound) const { return bound <= best_whole_; }

  /// The most promising first; what cannot win any more is left.
  void make_all_whole(std::vector<Candidate>& list) {
    std::vector<Candidate> out;
    for (std::size_t from = 0; from < list.size(); from += kWave) {
      std::vector<Candidate> wave;
      for (std::size_t i = from; i < std::min(from + kWave, list.size()); ++i) {
        if (may_win(list[i].rank() / kQuickFitOff)) wave.push_back(std::move(list[i]));
      }
      improve(wave, "capacitors", [&](Candidate& c) { return made_whole(c, width(2, 2), kQuickPairs); });
      for (Candidate& c : wave) {
        if (c.missing == 0.0) best_whole_ = std::min(best_whole_, c.rank());
        out.push_back(std::move(c));
      }
    }
    sort_by_rank(out);
    list = std::move(out);
  }

  bool made(Candidate& c) const {
    std::optional<Chain> chain = chain_design(c.stages, c.clocks, c.gains, target_);
    if (!chain) return false;
    c.design = std::move(chain->design);
    c.divisor = chain->divisor;
    c.halvings = std::move(chain->halvings);
    return true;
  }

  /// So many chains as the best of the list makes with so many op-amps.
  static std::size_t share_of(int opamps, const std::vector<Candidate>& list) {
    return static_cast<std::size_t>(std::max(6, opamps / std::max(2, list.front().design->opamps())));
  }

  /// The same stages at the same clocks; `exactly`: with the same capacitors.
  static bool alike(const Design& a, const Design& b, bool exactly) {
    return std::equal(a.stages.begin(), a.stages.end(), b.stages.begin(), b.stages.end(),
                      [&](const DesignStage& x, const DesignStage& y) {
                        return x.divisor == y.divisor && x.kind == y.kind && x.name == y.name &&
                               (!exactly || std::equal(x.c.begin(), x.c.end(), y.c.begin(), y.c.end(),
                                                       [](double p, double q) {
                                                         return std::abs(p - q) <= 1e-6 * std::max(p, q);
                                                       }));
                      });
  }
  static bool same_as_one(const std::vector<Candidate>& list, const Design& design) {
    return std::ranges::any_of(list,
                               [&](const Candidate& other) { return alike(*other.design, design, true); });
  }
  static void sort_by_rank(std::vector<Candidate>& list) {
    std::ranges::stable_sort(list,
                             [](const Candidate& a, const Candidate& b) { return a.place() < b.place(); });
  }

  /// Runs `step` on all, two at a time; keeps those for which it is true, by rank.
  template <class Step>
  void improve(std::vector<Candidate>& list, const std::string& what, Step step) {
    Progress progress(what + best_so_far_);
    std::atomic<std::size_t> done = 0;
    std::vector<char> kept(list.size(), 0);
    parallel_for(list.size(), kSearchThreads, [&](std::size_t i) {
      kept[i] = step(list[i]) ? 1 : 0;
      progress.at(static_cast<double>(++done) / static_cast<double>(list.size()));
    });
    std::vector<Candidate> out;
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (kept[i] != 0 && std::isfinite(list[i].score.total())) out.push_back(std::move(list[i]));
    }
    sort_by_rank(out);
    list = std::move(out);
    if (!list.empty())
      best_so_far_ =
          fmt::format(", {} % of 95 % of boards so far", rounded_text(100.0 * list[0].score.p95, 2));
  }

  bool fitted(Candidate& c, const DesignTarget& target, int iterations, int passes) const {
    const DesignTarget seen = with_clocks_seen(target, *c.design, sections_);
    const StageFactorTable table(seen);
    fit_design(*c.design, table, iterations, passes);
    scale_nodes(*c.design, table);
    c.score = full_bank_score(*c.design, table);
    return true;
  }

  DesignScore full_bank_score(const Design& design, const StageFactorTable& table) const {
    return score_of(with_full_banks(design), table, options_.assumptions, Spread::by_frequency);
  }

  /// The best chains with single stages at twice or half their clock, as long as that pays.
  void move_clocks(std::vector<Candidate>& list) {
    std::vector<Candidate> moved(
        list.begin(), list.begin() + static_cast<std::ptrdiff_t>(std::min(kMovedChains, list.size())));
    std::vector<Candidate> passed;
    for (Candidate& best : moved) {
      for (std::size_t round = 0; round < kMoveRounds; ++round) {
        std::vector<Candidate> near;
        for (std::size_t s = 0; s < best.halvings.size(); ++s) {
          for (const int by : {-1, 1}) {
            Candidate c = best;
            if (moved_clock(c, s, by) && !same_clocks(near, c)) near.push_back(std::move(c));
          }
        }
        improve(near, "clocks", [&](Candidate& c) { return fitted(c, target_, 25, 2); });
        if (near.empty() || near.front().rank() > kWorthMoving * best.rank()) break;
        best = std::move(near.front());
        if (same_clocks(passed, best)) break;  // another one has come this way
        passed.push_back(best);
      }
    }
    for (Candidate& c : moved) {
      if (!same_clocks(list, c)) list.push_back(std::move(c));
    }
    sort_by_rank(list);
  }

  bool moved_clock(Candidate& c, std::size_t stage, int by) const {
    c.clocks.halvings = c.halvings;
    c.clocks.one = c.divisor;
    c.clocks.halvings[stage] += by;
    if (c.clocks.halvings[stage] < 0) {
      if (c.divisor % 4 != 0) return false;
      *c.clocks.one /= 2;
      for (int& h : c.clocks.halvings) ++h;
      if (board_.master_clock.value / static_cast<double>(*c.clocks.one) > c.clocks.highest.value)
        return false;
    }
    return made(c);
  }

  static bool same_clocks(const std::vector<Candidate>& list, const Candidate& c) {
    return std::ranges::any_of(list, [&](const Candidate& other) {
      return other.sharing.left_out == c.sharing.left_out && alike(*other.design, *c.design, false);
    });
  }

  /// The best that the board has room for, with `opamps` op-amps together.
  void keep_placeable(std::vector<Candidate>& list, int opamps) {
    if (list.empty()) return;
    const std::size_t most = share_of(opamps, list);
    std::vector<Candidate> out;
    for (Candidate& c : list) {
      if (out.size() == most) break;
      const Design full = with_full_banks(*c.design);
      const Outcome<Plan> plan = plan_of_design(full, board_);
      if (const Refusal* refusal = refusal_of(plan)) {
        if (!why_not_) why_not_ = *refusal;
        continue;
      }
      out.push_back(std::move(c));
    }
    list = std::move(out);
  }

  RoundingWidth width(std::size_t designs, std::size_t choices) const {
    return {designs, choices, options_.assumptions.mismatch};
  }

  /// The fine grid, and what is wanted there of parts that follow at once, so that those of the board, which may be late, make of this
  /// design what is wanted.
  DesignTarget seen_closely(const Design& design) const {
    DesignTarget out = with_clocks_seen(fine_, design, sections_);
    if (options_.assumptions.slow.is_at_once()) return out;
    const Outcome<Plan> plan = plan_of_design(with_full_banks(design), board_);
    if (refusal_of(plan) != nullptr) return out;
    Plan late = std::get<Plan>(plan);
    late.slow = options_.assumptions.slow;
    const SwitchedBoard at_once(std::get<Plan>(plan)), as_it_runs(late);
    for (std::size_t k = 0; k < out.grid.size(); ++k) {
      const Complex by = as_it_runs.gain(out.grid[k]) / at_once.gain(out.grid[k]);
      if (std::isfinite(std::abs(by))) out.wanted[k] /= by;
    }
    return out;
  }

  void judge_whole(Candidate& c, const StageFactorTable& table) const {
    c.score = score_of(*c.design, table, options_.assumptions, Spread::by_drawn_boards);
    c.missing = c.score.missing();
  }

  /// Whole capacitors; the candidate's design stays as it was where there are none.
  bool made_whole(Candidate& c, RoundingWidth width, int pairs) const {
    const DesignTarget seen = seen_closely(*c.design);
    const StageFactorTable table(seen);
    c.exact = *c.design;
    fit_design(c.exact, table, 25, 3);
    c.score = full_bank_score(c.exact, table);
    c.bound = c.rank();
    if (!may_win(c.bound)) return false;
    Design whole = c.exact;
    if (!make_whole(whole, table, width)) return false;
    polish_pairs(whole, table, options_.assumptions.mismatch, pairs);
    c.design = std::move(whole);
    c.vendor = is_vendor(*c.design);
    judge_whole(c, table);
    return refusal_of(plan_of_design(*c.design, board_)) == nullptr;
  }

  /// Made whole once more with several partly whole designs side by side; whichever is better.
  bool refine(Candidate& c) const {
    Candidate again = c;
    again.design = c.exact;
    const DesignTarget seen = seen_closely(*c.design);
    const StageFactorTable table(seen);
    polish_pairs(*c.design, table, options_.assumptions.mismatch, kPairs);
    judge_whole(c, table);
    if (made_whole(again, width(3, 4), kPairs) && again.place() < c.place()) c = again;
    return true;
  }

  const Sections& sections_;
  const PlanOptions& options_;
  const Board& board_;
  DesignTarget target_, fine_;
  std::optional<std::int64_t> given_;
  std::optional<Refusal> why_not_;
  /// Rank of the best design with whole capacitors that has all that is wanted of a plan.
  double best_whole_ = std::numeric_limits<double>::infinity();
  std::string best_so_far_;  ///< for the progress line
};

}  // namespace

Outcome<std::vector<FoundPlan>> search_design(const Sections& sections, Band band, const PlanOptions& options,
                                              const Board& board) {
  return ChainSearch(sections, band, options, board).run();
}

}  // namespace bodesmith::fpaa
