#include "fpaa/clock_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr int kSearchPoints = 24;  ///< of the grid of the full search
constexpr int kQuickPoints = kSearchPoints / 2;
constexpr std::size_t kClocksJudged = 80;               ///< of the legal tree, evenly spread in ratio
constexpr std::size_t kClocksJudgedSettlingAlone = 16;  ///< each of them is a search of its own
constexpr std::size_t kClocksSearched = 2;              ///< the best of them get the full search
constexpr SearchEffort kQuickSearch{.candidates = 60, .beam = 20, .polished = 0};
/// Clock over the top of the band: twice the band is the least a sampled system can do.
constexpr double kMinClockOverBand = 2.5;
/// Of the settling product (1 + G) fc: gains are small.
constexpr double kMaxShareOfSettlingProduct = 0.5;
/// Logarithms of clocks this near are the same.
constexpr double kSameLogClock = 1e-12;

Refusal no_capacitors() {
  return {"no capacitors reach every corner at this clock"};
}

Outcome<ClockChoice> full_search(const TaskChain& chain, const LegalClock& clock, Band band,
                                 const Board& board) {
  auto problem = plan_problem(chain, clock.frequency, band, kSearchPoints, board.max_capacitor);
  if (!problem) return no_capacitors();
  ChainSolution solution = search_chain(problem->chain, {});
  if (!solution.made()) return no_capacitors();
  return ClockChoice{clock, std::move(*problem), std::move(solution)};
}

/// At most `count`, evenly spread in ratio.
std::vector<LegalClock> thinned_out(const std::vector<LegalClock>& all, std::size_t count) {
  if (all.size() <= count) return all;
  std::vector<LegalClock> out;
  const double from = std::log(all.front().frequency.value);
  const double to = std::log(all.back().frequency.value);
  std::size_t at = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double wanted = from + (to - from) * static_cast<double>(k) / static_cast<double>(count - 1);
    while (at + 1 < all.size() && std::log(all[at].frequency.value) < wanted - kSameLogClock) ++at;
    if (out.empty() || out.back().frequency != all[at].frequency) out.push_back(all[at]);
  }
  return out;
}

/// By the error of a quick search with the gain free, best first; clocks at which nothing can be made are
/// left out.
std::vector<LegalClock> ranked_by_shape(const TaskChain& chain, const std::vector<LegalClock>& clocks,
                                        Band band, const Board& board) {
  struct Scored {
    double error;
    LegalClock clock;
  };
  std::vector<Scored> scored;
  for (const LegalClock& clock : clocks) {
    const auto problem = plan_problem(chain, clock.frequency, band, kQuickPoints, board.max_capacitor);
    if (!problem) continue;
    const ChainSolution rough = search_chain(problem->chain, kQuickSearch);
    if (rough.made()) scored.push_back({rough.shape_error, clock});
  }
  std::stable_sort(scored.begin(), scored.end(),
                   [](const Scored& a, const Scored& b) { return a.error < b.error; });
  std::vector<LegalClock> out;
  for (const Scored& s : scored) out.push_back(s.clock);
  return out;
}

/// The first corner that cannot be had at this clock, in words.
std::optional<std::string> unreachable_corner(const TaskChain& chain, Hertz clock, int max_capacitor) {
  for (const CamTaskPtr& task : chain.tasks) {
    if (auto text = task->unreachable_corner(clock, max_capacitor)) return text;
  }
  return std::nullopt;
}

Outcome<LegalClock> checked_clock(const TaskChain& chain, Hertz wanted, Band band, const Board& board) {
  if (!(wanted.value > 0.0) || !std::isfinite(wanted.value)) {
    return Refusal{fmt::format("the clock is {} Hz, expected a frequency above 0", wanted.value)};
  }
  const auto clock = find_clock(board, wanted);
  if (!clock) {
    return Refusal{
        fmt::format("a clock of {} Hz is not in the tree of {} ({} Hz divided twice by 1, 2, 4 ... 510), the "
                    "nearest is {} Hz",
                    number_text(wanted.value), board.name, number_text(board.master_clock.value),
                    number_text(nearest_clock(board, wanted).frequency.value))};
  }
  if (const auto corner = unreachable_corner(chain, clock->frequency, board.max_capacitor)) {
    const Band reach = possible_clocks(chain, board.max_capacitor);
    return Refusal{
        fmt::format("{} cannot be reached at a clock of {} Hz with capacitors of 1 to {} units, expected a "
                    "clock between {} and {} Hz",
                    *corner, number_text(wanted.value), board.max_capacitor, rounded_text(reach.from.value),
                    rounded_text(reach.to.value))};
  }
  if (band.to.value >= 0.5 * clock->frequency.value) {
    return Refusal{fmt::format("a clock of {} Hz cannot serve a band up to {} Hz, expected more than {} Hz",
                               number_text(wanted.value), rounded_text(band.to.value),
                               rounded_text(2.0 * band.to.value))};
  }
  return *clock;
}

}  // namespace

Outcome<ClockChoice> at_given_clock(const TaskChain& chain, Hertz wanted, Band band, const Board& board) {
  const Outcome<LegalClock> clock = checked_clock(chain, wanted, band, board);
  if (const Refusal* refusal = refusal_of(clock)) return *refusal;
  return full_search(chain, std::get<LegalClock>(clock), band, board);
}

Outcome<ClockChoice> at_best_clock(const TaskChain& chain, Band band, const Board& board) {
  const Band reach = possible_clocks(chain, board.max_capacitor);
  const Hertz from{std::max(reach.from.value, kMinClockOverBand * band.to.value)};
  const Hertz to{std::min(reach.to.value, kMaxShareOfSettlingProduct * board.settling_product.value)};
  const std::vector<LegalClock> legal = legal_clocks(board, from, to);
  if (legal.empty()) {
    return Refusal{fmt::format(
        "no clock serves all corners: the lowest needs at most {} Hz, the highest (and twice the band) at "
        "least {} Hz; expected corners within a ratio of about 400, or the extreme sections made with spice",
        rounded_text(to.value), rounded_text(from.value))};
  }
  const bool settling_alone = std::any_of(chain.tasks.begin(), chain.tasks.end(),
                                          [](const CamTaskPtr& task) { return task->is_settled_alone(); });
  const std::size_t count = settling_alone ? kClocksJudgedSettlingAlone : kClocksJudged;
  std::vector<LegalClock> ranked = ranked_by_shape(chain, thinned_out(legal, count), band, board);
  if (ranked.size() > kClocksSearched) ranked.resize(kClocksSearched);
  Outcome<ClockChoice> best = no_capacitors();
  for (const LegalClock& clock : ranked) {
    Outcome<ClockChoice> choice = full_search(chain, clock, band, board);
    const auto* found = std::get_if<ClockChoice>(&choice);
    const auto* so_far = std::get_if<ClockChoice>(&best);
    if (found == nullptr) continue;
    if (so_far == nullptr || found->solution.max_complex_error < so_far->solution.max_complex_error) {
      best = std::move(choice);
    }
  }
  return best;
}

}  // namespace bodesmith::fpaa
