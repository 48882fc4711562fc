#include "fpaa/topology_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/progress.hpp"
#include "base/whole_number.hpp"
#include "fpaa/clock_features.hpp"
#include "fpaa/error_budget.hpp"
#include "fpaa/error_reference.hpp"
#include "fpaa/network_cascade.hpp"
#include "fpaa/network_parallel.hpp"
#include "fpaa/network_plan.hpp"
#include "numeric/parallel_for.hpp"

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;

constexpr double kBeyondBand = 50.0;
constexpr double kBeyondWeight = 0.3;
constexpr double kClockOverFrequency = 160.0;
/// A zero of the wanted response on the axis: errors near it count against this share of the peak.
constexpr double kSoftZero = 1e-5;
/// Each op-amp has to earn this share of the error.
constexpr double kOpampCost = 0.01;
/// How much of the spread by mismatch counts beside the error of the plan itself.
constexpr double kMismatchShare = 0.25;
/// And in the last polish, where the error itself comes first.
constexpr double kPolishShare = 0.05;
/// Of the candidates: how many are made whole again with more care, the best as they are and those that were
/// best before their capacitors were whole.
constexpr double kGoodEnough = 3e-3;  ///< an error in the band that needs none of that
constexpr std::size_t kRefinedBest = 4;
constexpr std::size_t kRefinedExact = 2;
constexpr int kPolishRounds = 40;
constexpr int kSearchThreads = 2;
constexpr double kNearPoles = 1.15;
/// A response that falls below this share of its peak towards low frequencies has a high pass first.
constexpr double kFallen = 0.1;
/// Clock over the high pass's pole (in rad/s): within one capacitor ratio.
constexpr double kHighPassReach = 225.0;
constexpr double kPairReach = 6.0;
constexpr std::size_t kManyPaths = 6;
/// A band that goes up to this share of the sums' clock is worth a lead in every path.
constexpr double kWorthLeading = 3e-4;
/// A sine beside a clock within the band comes back as a slow beat: worth this share of the error.
constexpr double kBeatCost = 1.0;
/// And each further chip this.
constexpr double kChipCost = 0.15;
/// With paths that sample within the band and an error above the first, all clocks above the second times the band
/// are tried too.
constexpr double kWorthQuicker = 8e-3;
constexpr double kQuicker = 2.2;

struct TopologyCandidate {
  Network network;
  Network exact;  ///< before its capacitors were whole
  double exact_error = 0.0;
  NetworkScore score;
  std::string topology;
  bool beats = false;     ///< some path samples at a clock within twice the band
  double clipping = 1.0;  ///< clipping_of()
  double rank() const {
    return score.total * (1.0 + kOpampCost * network.opamps()) * (beats ? 1.0 + kBeatCost : 1.0) *
           clipping_cost(clipping);
  }
};

/// A closer grid, and points beside the multiples of slow clocks: held outputs have narrow features there.
NetworkTarget seen_closer(NetworkTarget target, const Network& network, const Sections& sections) {
  const Band band = target.band;
  constexpr int kCloser = 240;
  const double soft = 1.0 / *std::max_element(target.reciprocal.begin(), target.reciprocal.end());
  const auto add = [&](Hertz f) {
    const Complex wanted = sections.response(f.rad_s());
    target.grid.push_back(f.rad_s());
    target.wanted.push_back(wanted);
    target.weight.push_back(1.0);
    target.reciprocal.push_back(1.0 / std::max(error_reference(sections, f.rad_s()), soft));
  };
  for (const Hertz f : log_grid(band, kCloser)) add(f);
  for (const NetworkStage& stage : network.stages) {
    for (const double multiple : {0.5, 0.97, 1.03, 1.5, 1.97, 2.03}) {
      const Hertz f{multiple * target.master_hz / static_cast<double>(stage.divisor)};
      if (f >= band.from && f <= band.to) add(f);
    }
  }
  constexpr double kBeside[] = {-10.0, -3.0, -1.0, -0.5, -0.2, 0.2, 0.5, 1.0, 3.0, 10.0};
  for (const Hertz f : near_clocks(clocked_poles(network, target.master_hz), band, kBeside, 20)) add(f);
  return target;
}

/// Some points beside the clocks within the band, for the fit.
NetworkTarget with_clocks_seen(NetworkTarget target, const std::vector<ClockedPole>& poles,
                               const Sections& sections) {
  constexpr double kBeside[] = {-3.0, -0.6, 0.2, 0.6, 3.0};
  constexpr int kMultiples = 4;
  const double soft = 1.0 / *std::max_element(target.reciprocal.begin(), target.reciprocal.end());
  for (const Hertz f : near_clocks(poles, target.band, kBeside, kMultiples)) {
    target.grid.push_back(f.rad_s());
    target.wanted.push_back(sections.response(f.rad_s()));
    target.weight.push_back(1.0);
    target.reciprocal.push_back(1.0 / std::max(error_reference(sections, f.rad_s()), soft));
  }
  return target;
}

std::vector<ClockedPole> clocked_poles(const std::vector<ParallelPath>& paths, double master_hz) {
  std::vector<ClockedPole> out;
  for (const ParallelPath& path : paths) {
    out.push_back({{master_hz / static_cast<double>(path.divisor)}, path.pole / (2.0 * std::numbers::pi)});
  }
  return out;
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

  /// A path for each real pole and each complex pair; real poles that lie near each other as one path of two.
  static std::vector<ParallelPath> paths_of(std::vector<Complex> poles, bool pair_near) {
    std::vector<ParallelPath> out;
    std::sort(poles.begin(), poles.end(), [](Complex a, Complex b) {
      return std::abs(a) != std::abs(b) ? std::abs(a) < std::abs(b) : a.imag() < b.imag();
    });
    for (std::size_t i = 0; i < poles.size(); ++i) {
      const bool pair = poles[i].imag() != 0.0;
      const bool near = pair_near && !pair && i + 1 < poles.size() && poles[i + 1].imag() == 0.0 &&
                        std::abs(poles[i + 1]) < kNearPoles * std::abs(poles[i]);
      if (pair) {
        if (poles[i].imag() > 0.0) out.push_back({poles[i], std::conj(poles[i])});
      } else if (near) {
        // Two poles at the same place have no partial fractions of their own.
        out.push_back({poles[i], poles[i + 1]});
        ++i;
      } else {
        out.push_back({poles[i], std::nullopt});
      }
    }
    return out;
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

  /// The gain of the output in front of all paths, leading by half a period.
  static NetworkStage first_gain(const NetworkTarget& target, std::int64_t divisor) {
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
    const NetworkTarget target =
        network_target(sections_, band_, board_.master_clock.value / static_cast<double>(divisor), board_);
    const NetworkResponse response(target);
    for (int leads = 0; leads <= 2; ++leads) {
      auto network = cascade_network(roots_, response, {.divisor = divisor, .leads = leads});
      if (!network) return;
      if (!set_gain(*network, response)) continue;
      fit_network(*network, response, 40, 3);
      keep(*std::move(network), response, "cascade");
    }
  }

  /// False when the sign is wrong: an even number of inverting stages too few or too many.
  static bool set_gain(Network& network, const NetworkResponse& response) {
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

  /// Poles that the fast clock does not reach with one ratio are paths, with as many of the lowest zeros; the
  /// other roots a cascade in front.
  void try_mixed(std::int64_t divisor) {
    NetworkTarget clocks;
    clocks.master_hz = board_.master_clock.value;
    const SplitRoots split = split_roots(lowest_one_ratio_corner(divisor, clocks));
    if (split.slow.empty() || split.fast.poles.empty() || split.taken == 0) return;
    try_parallel(divisor, split.fast, paths_of(split.slow, false), "cascade and parallel");
  }

  /// Where the response falls towards low frequencies, slow paths taken from a constant leave the small
  /// difference of large numbers. Instead a high pass with its zero at 0 exactly (one ratio at the fast clock)
  /// goes first, so that everything behind it is small there too; what the sections have left at DC enters by
  /// paths ahead of the high pass, with small weights:
  ///   N/prod(s + p_i) = s/(s + p_j) (c + sum r_i p_i/(s + p_i)) + sum q_i p_i/(s + p_i)
  void try_high_passed() {
    const std::optional<double> pole = high_pass_pole();
    if (!pole) return;
    const double total = board_.master_clock.value / (kHighPassReach * *pole);
    const std::int64_t divisor =
        std::max<std::int64_t>(4, 2 * whole_number<std::int64_t>(std::ceil(0.5 * total)));
    const NetworkTarget target = target_at(divisor);
    const NetworkResponse response(target);
    double peak = 0.0;
    for (std::size_t k = 0; k < target.grid.size(); ++k) {
      if (target.weight[k] >= 1.0) peak = std::max(peak, std::abs(target.wanted[k]));
    }
    if (std::abs(target.wanted.front()) > kFallen * peak) return;
    SplitRoots split = split_roots(0.999 * *pole);
    const auto is_pole = [&](Complex p) { return p.imag() == 0.0 && -p.real() == *pole; };
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

  /// The lowest real pole that one ratio reaches at a clock that is fast enough for the band, rad/s.
  std::optional<double> high_pass_pole() const {
    constexpr double kClockOverBand = 20.0;
    std::optional<double> out;
    for (const Complex& pole : roots_.poles) {
      if (pole.imag() != 0.0 || kHighPassReach * -pole.real() < kClockOverBand * band_.to.value) continue;
      if (!out || -pole.real() < *out) out = -pole.real();
    }
    return out;
  }

  static NetworkStage high_pass_stage(const NetworkTarget& target, std::int64_t divisor, double pole,
                                      int from) {
    const double ratio = target.master_hz / static_cast<double>(divisor) / pole;  // aCout/Cout
    NetworkStage out;
    out.name = "HighPass0";
    out.divisor = divisor;
    out.from = {from};
    const double cout = std::max(1.0, 200.0 / ratio);
    out.c = {0.0, ratio * cout, cout, ratio * cout};
    out.free = {0, 1, 0, 1};
    return out;
  }

  /// Poles below a corner, with as many of the lowest zeros, and the rest.
  struct SplitRoots {
    NetworkRoots fast;
    std::vector<Complex> slow;
    std::size_t taken = 0;  ///< zeros
  };
  SplitRoots split_roots(double lowest) const {
    SplitRoots out;
    // A complex pair takes more of the capacitors' range.
    for (const Complex& pole : roots_.poles) {
      const double reach = pole.imag() != 0.0 ? kPairReach * lowest : lowest;
      (std::abs(pole) < reach ? out.slow : out.fast.poles).push_back(pole);
    }
    out.fast.zeros = roots_.zeros;
    std::sort(out.fast.zeros.begin(), out.fast.zeros.end(),
              [](Complex a, Complex b) { return std::abs(a) < std::abs(b); });
    out.taken = take_lowest_zeros(out.fast.zeros, 0, out.slow.size());
    return out;
  }

  /// Takes the lowest zeros out until `most` are taken (`taken` are already); pairs stay together.
  static std::size_t take_lowest_zeros(std::vector<Complex>& zeros, std::size_t taken, std::size_t most) {
    for (std::size_t i = 0; i < zeros.size() && taken < most;) {
      const std::size_t size = zeros[i].imag() == 0.0 ? 1 : 2;
      if (taken + size > most) {
        i += size;
        continue;
      }
      const auto from = zeros.begin() + static_cast<std::ptrdiff_t>(i);
      zeros.erase(from, from + static_cast<std::ptrdiff_t>(size));
      taken += size;
    }
    return taken;
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
    found = TopologySearch(sections, band, options, board).run();
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

NetworkTarget network_target(const Sections& sections, Band band, double fast_clock_hz, const Board& board) {
  constexpr double kPointsPerDecade = 18.0;
  NetworkTarget out;
  out.band = band;
  out.master_hz = board.master_clock.value;
  out.max_capacitor = board.max_capacitor;
  const auto points = [](Band b) {
    const double decades = std::log10(b.to.value / b.from.value);
    return whole_number<int>(kPointsPerDecade * decades, 36, 130);
  };
  const auto add = [&](Hertz f, double weight) {
    out.grid.push_back(f.rad_s());
    out.wanted.push_back(sections.response(f.rad_s()));
    out.weight.push_back(weight);
  };
  for (const Hertz f : log_grid(band, points(band))) add(f, 1.0);
  const double end = std::min(kBeyondBand * band.to.value, fast_clock_hz / kClockOverFrequency);
  if (end > 1.3 * band.to.value) {
    const Band beyond{{1.15 * band.to.value}, {end}};
    for (const Hertz f : log_grid(beyond, 20)) add(f, kBeyondWeight);
  }
  double peak = 0.0;
  for (const Complex& h : out.wanted) peak = std::max(peak, std::abs(h));
  for (const RadPerSecond w : out.grid) {
    out.reciprocal.push_back(1.0 / std::max(error_reference(sections, w), kSoftZero * peak));
  }
  return out;
}

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
