#include "fpaa/topology_candidates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/whole_number.hpp"
#include "fpaa/network_plan.hpp"
#include "fpaa/topology_roots.hpp"
#include "fpaa/topology_target.hpp"

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;

/// Each op-amp has to earn this share of the error.
constexpr double kOpampCost = 0.01;
/// A response that falls below this share of its peak towards low frequencies has a high pass first.
constexpr double kFallen = 0.1;
constexpr std::size_t kManyPaths = 6;
/// A band that goes up to this share of the sums' clock is worth a lead in every path.
constexpr double kWorthLeading = 3e-4;
/// A sine beside a clock within the band comes back as a slow beat: worth this share of the error.
constexpr double kBeatCost = 1.0;

/// The gain of the output in front of all paths, leading by half a period.
NetworkStage first_gain(const NetworkTarget& target, std::int64_t divisor) {
  constexpr double kMostGain = 40.0;
  double peak = 0.0;
  for (std::size_t k = 0; k < target.grid.size(); ++k) {
    if (target.weight[k] >= 1.0) peak = std::max(peak, std::abs(target.wanted[k]));
  }
  const double gain = std::clamp(peak, 1.0 / kMostGain, kMostGain);
  const double cout = 120.0 / std::max(1.0, gain);
  NetworkStage out;
  out.name = "Gain0";
  out.divisor = divisor;
  out.from = {NetworkStage::kBoardInput};
  out.c = {gain * cout, 0.75 * gain * cout, cout, 0.25 * cout};
  out.free = {0, 1, 0, 0};
  return out;
}

NetworkStage high_pass_stage(const NetworkTarget& target, std::int64_t divisor, RadPerSecond pole, int from) {
  const double ratio = target.master_hz / static_cast<double>(divisor) / pole.value;  // aCout/Cout
  NetworkStage out;
  out.name = "HighPass0";
  out.divisor = divisor;
  out.from = {from};
  const double cout = std::max(1.0, 200.0 / ratio);
  out.c = {0.0, ratio * cout, cout, ratio * cout};
  out.free = {0, 1, 0, 1};
  return out;
}

/// False when the sign is wrong: an even number of inverting stages too few or too many.
bool set_gain(Network& network, const NetworkResponse& response) {
  const NetworkTarget& target = response.target();
  const std::vector<Complex> got = response.output(network);
  Complex mean = 0.0;
  double size = 0.0;
  double count = 0.0;
  for (std::size_t k = 0; k < got.size(); ++k) {
    if (target.weight[k] < 1.0) continue;
    const Complex ratio = got[k] / target.wanted[k];
    if (!(std::abs(ratio) > 0.0) || !std::isfinite(std::abs(ratio))) continue;
    mean += ratio / std::abs(ratio);
    size += std::log(std::abs(ratio));
    count += 1.0;
  }
  if (!(mean.real() > 0.0) || count == 0.0) return false;
  // Shared evenly.
  const double each = std::exp(-size / count / static_cast<double>(network.stages.size()));
  for (NetworkStage& stage : network.stages) {
    const std::size_t inputs = stage.kind == NetworkStage::Kind::first ? 2 : 3;
    for (std::size_t i = 0; i < inputs; ++i) stage.c[i] *= each;
  }
  return true;
}

/// Collects candidates; each is fitted, rounded and polished.
class TopologySearch {
 public:
  TopologySearch(const Sections& sections, Band band, const PlanOptions& options, const Board& board)
      : sections_(sections), band_(band), options_(options), board_(board), roots_(roots_of(sections)) {}

  std::vector<TopologyCandidate> run() {
    using Topology = PlanOptions::Topology;
    if (options_.topology != Topology::cascade) {
      for (const std::int64_t divisor : sum_divisors()) {
        const double off = gain_to_bring();
        if (off < 10.0) try_parallel(divisor, NetworkRoots{}, paths_of(roots_.poles, false), "parallel");
        if (off > 3.0) {
          try_parallel(divisor, NetworkRoots{}, paths_of(roots_.poles, false), "parallel", true);
        }
        const auto paired = paths_of(roots_.poles, true);
        if (paired.size() < paths_of(roots_.poles, false).size()) {
          try_parallel(divisor, NetworkRoots{}, paired, "parallel");
        }
      }
    }
    if (options_.topology != Topology::parallel) {
      for (const double over : {16.0, 40.0, 100.0, 250.0}) try_cascade(divisor_for(over * band_.to.value));
    }
    if (options_.topology == Topology::automatic) {
      for (const std::int64_t divisor : mixed_divisors()) {
        try_mixed(divisor);
      }
      try_high_passed();
    }
    std::stable_sort(
        found_.begin(), found_.end(),
        [](const TopologyCandidate& a, const TopologyCandidate& b) { return a.rank() < b.rank(); });
    return std::move(found_);
  }

 private:
  /// The total divisor (even; beyond 510 by a system clock first) whose clock is at least `hz`, if one is.
  std::int64_t divisor_for(double hz) const {
    const double lowest = std::max(hz, options_.lowest_clock.value_or(Hertz{0.0}).value);
    const double total = std::clamp(board_.master_clock.value / lowest, 2.0, 250000.0);
    if (total <= 510.0) return 2 * whole_number<std::int64_t>(total / 2.0);
    const auto system = 2 * whole_number<std::int64_t>(std::ceil(total / 1000.0));
    return system * 2 * whole_number<std::int64_t>(total / (2.0 * static_cast<double>(system)));
  }

  /// Of the sums: fast against the band, and against what lies above it.
  std::vector<std::int64_t> sum_divisors() const {
    const auto even = [&](double over) {
      return std::clamp<std::int64_t>(divisor_for(over * band_.to.value), 4, 510);
    };
    std::vector<std::int64_t> out{even(8000.0)};
    if (even(200.0) == 4 && band_.to.value > 4e4) out.push_back(2);
    return out;
  }

  /// Of a cascade in front of slow paths: as fast as the sums, and slower, where more poles are within reach.
  std::vector<std::int64_t> mixed_divisors() const {
    std::vector<std::int64_t> out = sum_divisors();
    for (const double over : {400.0, 100.0, 40.0}) {
      const auto divisor = std::clamp<std::int64_t>(divisor_for(over * band_.to.value), 4, 510);
      if (divisor >= 2 * out.back()) out.push_back(divisor);
    }
    return out;
  }

  /// How far the peak of the output is from that of the input, as a ratio above 1.
  double gain_to_bring() const {
    double peak = 0.0;
    for (const Hertz f : log_grid(band_, 60)) peak = std::max(peak, std::abs(sections_.response(f.rad_s())));
    return std::max(peak, 1.0 / peak);
  }

  void keep(Network network, const NetworkResponse& response, const char* topology) {
    // Whole capacitors will not make it better than this.
    const double exact_error = largest_error(response.errors(network));
    if (!(exact_error <= least_rank_) || is_tried(network)) return;
    // Numbers beyond all capacitors leave paths, and then stages, that nothing enters.
    if (std::any_of(network.stages.begin(), network.stages.end(),
                    [](const NetworkStage& stage) { return stage.from.empty(); }))
      return;
    TopologyCandidate out{network, std::move(network), exact_error, {}, topology};
    if (!round_network(out.network, response)) return;
    polish_network(out.network, response, options_.assumptions.mismatch, 0.0, 4);
    const NetworkTarget closer = seen_closer(response.target(), out.network, sections_);
    out.score =
        network_score(out.network, NetworkResponse(closer), options_.assumptions.mismatch, kMismatchShare);
    if (!std::isfinite(out.score.total)) return;
    out.beats =
        std::any_of(out.network.stages.begin(), out.network.stages.end(), [&](const NetworkStage& stage) {
          return board_.master_clock.value < 2.0 * band_.to.value * static_cast<double>(stage.divisor);
        });
    out.clipping = clipping_of(out.network, response);
    least_rank_ = std::min(least_rank_, out.rank());
    found_.push_back(std::move(out));
  }

  /// Sizes of capacitors that no path uses make the same network again.
  bool is_tried(const Network& network) {
    const auto same = [&](const Network& other) {
      constexpr double kSame = 1e-4;
      if (other.stages.size() != network.stages.size()) return false;
      for (std::size_t s = 0; s < network.stages.size(); ++s) {
        const NetworkStage& a = network.stages[s];
        const NetworkStage& b = other.stages[s];
        if (a.kind != b.kind || a.divisor != b.divisor || a.from != b.from) return false;
        for (std::size_t c = 0; c < a.c.size(); ++c) {
          if (std::abs(a.c[c] - b.c[c]) > kSame * std::max(1.0, a.c[c])) return false;
        }
      }
      return true;
    };
    if (std::any_of(tried_.begin(), tried_.end(), same)) return true;
    tried_.push_back(network);
    return false;
  }

  /// Of the networks fitted, those worth rounding: the best, and a smaller one that is hardly worse.
  struct Fitted {
    std::vector<ParallelPath> paths;
    double error = 0.0;
  };

  void try_parallel(std::int64_t divisor, const NetworkRoots& before_roots,
                    const std::vector<ParallelPath>& all, const char* topology, bool gained = false) {
    if (all.empty()) return;
    const NetworkTarget target = target_at(divisor);
    const NetworkResponse response(target);
    Network before;
    if (!before_roots.poles.empty()) {
      auto cascade = cascade_network(before_roots, response, {.divisor = divisor, .leads = 0});
      if (!cascade) return;
      before = *std::move(cascade);
    } else if (gained) {
      before.stages.push_back(first_gain(target, divisor));
    }
    search_paths(divisor, before, response, all, topology);
  }

  NetworkTarget target_at(std::int64_t divisor) const {
    return network_target(sections_, band_, board_.master_clock.value / static_cast<double>(divisor), board_);
  }

  /// Numbers of paths behind `before`, and sizes of their capacitors.
  void search_paths(std::int64_t divisor, const Network& before, const NetworkResponse& response,
                    const std::vector<ParallelPath>& all, const char* topology) {
    const NetworkTarget& target = response.target();
    ParallelOptions options;
    options.sum_divisor = divisor;
    options.cout = 4;
    options.lead = kWorthLeading * board_.master_clock.value < band_.to.value * static_cast<double>(divisor);
    if (options_.lowest_clock) options.lowest_clock_hz = options_.lowest_clock->value;
    std::vector<ParallelPath> paths = with_clocks(all, target, options);
    std::vector<Fitted> fitted;
    // Then with two ratios where one ratio's clock is too slow, the faster the more its first op-amp swings.
    for (const double clock_over : {12.0, 40.0, 0.0}) {
      const NetworkTarget seen = with_clocks_seen(target, clocked_poles(paths, target.master_hz), sections_);
      const NetworkResponse at_clocks(seen);
      const auto lists = fewer_paths(paths, before, at_clocks, options);
      for (Fitted& fit : fitted_lists(lists, before, at_clocks, options)) fitted.push_back(std::move(fit));
      if (clock_over == 0.0) break;
      paths = all;
      paths = with_clocks(paths, target, options);
      if (!quicken_paths(paths, before, at_clocks, options, clock_over)) break;
      paths = with_clocks(paths, target, options);
    }
    for (const Fitted& fit : fitted) {
      for (const int cout : {3, 9, 24}) {
        // A long sum is slow to search: the sizes between will do.
        if (cout > 9 && fit.paths.size() > kManyPaths) continue;
        options.cout = cout;
        const std::vector<ParallelPath> clocked = with_clocks(fit.paths, target, options);
        const NetworkTarget seen =
            with_clocks_seen(target, clocked_poles(clocked, target.master_hz), sections_);
        const NetworkResponse at_clocks(seen);
        Network network = parallel_network(clocked, before, at_clocks, options);
        fit_network(network, at_clocks, 25, 3);
        keep(std::move(network), at_clocks, topology);
      }
    }
  }

  /// The shortest lists that do as well as the longest, or nearly.
  std::vector<Fitted> fitted_lists(const std::vector<std::vector<ParallelPath>>& lists, const Network& before,
                                   const NetworkResponse& response, const ParallelOptions& options) const {
    constexpr double kWorthFitting = 10.0;  // times the cost of the longest list
    constexpr std::size_t kFitted = 5;
    constexpr double kNearlyAsGood = 2.0;
    const double cost = parallel_weights(lists.back(), before, response, options).cost;
    std::vector<Fitted> out;
    for (std::size_t k = 0; k < lists.size() && out.size() < kFitted; ++k) {
      const bool last = k + 1 == lists.size();
      if (!last && parallel_weights(lists[k], before, response, options).cost > kWorthFitting * cost)
        continue;
      Network network = parallel_network(lists[k], before, response, options);
      fit_network(network, response, 20, 1);
      out.push_back({lists[k], largest_error(response.errors(network))});
    }
    double least = std::numeric_limits<double>::infinity();
    for (const Fitted& fit : out) least = std::min(least, fit.error);
    std::vector<Fitted> kept;
    for (Fitted& fit : out) {
      if (kept.size() < 2 && fit.error <= std::max(kNearlyAsGood * least, 3e-4))
        kept.push_back(std::move(fit));
    }
    return kept;
  }

  void try_cascade(std::int64_t divisor) {
    if (divisor == tried_cascade_) return;
    tried_cascade_ = divisor;
    const NetworkTarget target = target_at(divisor);
    const NetworkResponse response(target);
    for (int leads = 0; leads <= 2; ++leads) {
      auto network = cascade_network(roots_, response, {.divisor = divisor, .leads = leads});
      if (!network) return;
      if (!set_gain(*network, response)) continue;
      fit_network(*network, response, 40, 3);
      keep(*std::move(network), response, "cascade");
    }
  }

  /// Poles that the fast clock does not reach with one ratio are paths, with as many of the lowest zeros; the
  /// other roots a cascade in front.
  void try_mixed(std::int64_t divisor) {
    NetworkTarget clocks;
    clocks.master_hz = board_.master_clock.value;
    const SplitRoots split = split_roots(roots_, RadPerSecond{lowest_one_ratio_corner(divisor, clocks)});
    if (split.slow.empty() || split.fast.poles.empty() || split.taken == 0) return;
    try_parallel(divisor, split.fast, paths_of(split.slow, false), "cascade and parallel");
  }

  /// Where the response falls towards low frequencies, slow paths taken from a constant leave the small
  /// difference of large numbers. Instead a high pass with its zero at 0 exactly (one ratio at the fast clock)
  /// goes first, so that everything behind it is small there too; what the sections have left at DC enters by
  /// paths ahead of the high pass, with small weights:
  ///   N/prod(s + p_i) = s/(s + p_j) (c + sum r_i p_i/(s + p_i)) + sum q_i p_i/(s + p_i)
  void try_high_passed() {
    const std::optional<RadPerSecond> pole = high_pass_pole(roots_, band_);
    if (!pole) return;
    const double total = board_.master_clock.value / (kHighPassReach * pole->value);
    const std::int64_t divisor =
        std::max<std::int64_t>(4, 2 * whole_number<std::int64_t>(std::ceil(0.5 * total)));
    const NetworkTarget target = target_at(divisor);
    const NetworkResponse response(target);
    double peak = 0.0;
    for (std::size_t k = 0; k < target.grid.size(); ++k) {
      if (target.weight[k] >= 1.0) peak = std::max(peak, std::abs(target.wanted[k]));
    }
    if (std::abs(target.wanted.front()) > kFallen * peak) return;
    SplitRoots split = split_roots(roots_, RadPerSecond{0.999 * pole->value});
    const auto is_pole = [&](Complex p) { return p.imag() == 0.0 && -p.real() == pole->value; };
    const auto at = std::find_if(split.fast.poles.begin(), split.fast.poles.end(), is_pole);
    if (at == split.fast.poles.end() || split.slow.empty()) return;
    split.fast.poles.erase(at);
    // With it the paths make one more zero.
    take_lowest_zeros(split.fast.zeros, split.taken, split.slow.size() + 1);
    Network before;
    if (!split.fast.poles.empty()) {
      auto cascade = cascade_network(split.fast, response, {.divisor = divisor, .leads = 0});
      if (!cascade) return;
      before = *std::move(cascade);
    }
    before.stages.push_back(
        high_pass_stage(target, divisor, *pole, static_cast<int>(before.stages.size()) - 1));
    for (const bool pair_near : {false, true}) {
      std::vector<ParallelPath> paths = paths_of(split.slow, pair_near);
      const std::size_t own = paths.size();
      if (pair_near && own == split.slow.size()) break;
      for (std::size_t i = 0; i < own; ++i) {
        paths.push_back(paths[i]);
        paths.back().ahead = true;
      }
      search_paths(divisor, before, response, paths, "high pass and parallel");
    }
  }

  const Sections& sections_;
  Band band_;
  const PlanOptions& options_;
  const Board& board_;
  NetworkRoots roots_;
  std::vector<TopologyCandidate> found_;
  std::vector<Network> tried_;
  double least_rank_ = std::numeric_limits<double>::infinity();
  std::int64_t tried_cascade_ = 0;
};

}  // namespace

double TopologyCandidate::rank() const {
  return score.total * (1.0 + kOpampCost * network.opamps()) * (beats ? 1.0 + kBeatCost : 1.0) *
         clipping_cost(clipping);
}

std::vector<TopologyCandidate> topology_candidates(const Sections& sections, Band band,
                                                   const PlanOptions& options, const Board& board) {
  return TopologySearch(sections, band, options, board).run();
}

}  // namespace bodesmith::fpaa
