#include "fpaa/network_parallel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "base/progress.hpp"
#include "base/whole_number.hpp"
#include "numeric/dense.hpp"

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;
using Stage = NetworkStage;

constexpr double kSumOut = 60.0;       ///< Cout of a sum to start with
constexpr double kSumStatic = 15.0;    ///< its aCout
constexpr double kLargestRatio = 250;  ///< Cint to Cout with one unit of Cout; the fit may move it to 255
constexpr double kSlowestDivisor = 500.0 * 500.0;
/// Of the two ratios of a low pass by ratios: C2 C3/(CA C4) is never smaller than the reciprocal.
constexpr double kTwoRatios = 30000.0;
/// A path's hold may cost this much of the wanted response before two ratios make its clock faster.
constexpr double kHoldWorthRatios = 2e-3;
/// A weight of a sum this share of the largest still is many units; smaller ones are shared with the path's own
/// gain.
/// One this much smaller is given two ratios of its own.
constexpr double kSplitWeight = 1.0 / 40.0;
constexpr double kSmallWeight = 1.0 / 12.0;
constexpr std::int64_t kLargestOneDivisor = 510;
/// An output beyond these (against the input) has its gain shared between the sums.
constexpr double kFaint = 0.2;
constexpr double kLoud = 20.0;
/// The ratios of a second-order path are smaller: its quality takes one more on top.
constexpr double kSecondOrderShare = 0.5;
constexpr double kNegligibleWeight = 1e-7;

/// D of a pole: 1 - exp(-s T).
Complex d_pole(Complex s, double period) {
  return 1.0 - std::exp(-s * period);
}
double period_of(std::int64_t divisor, const NetworkTarget& target) {
  return static_cast<double>(divisor) / target.master_hz;
}

/// D^2 + linear D + constant with these poles.
struct SecondOrder {
  double constant;
  double linear;
};
SecondOrder second_order(const ParallelPath& path, double period) {
  const Complex a = d_pole(path.pole, period);
  const Complex b = d_pole(*path.second, period);
  return {(a * b).real(), -(a + b).real()};
}

/// Complex poles whose damping wants two ratios.
bool is_high_quality(const ParallelPath& path) {
  constexpr double kResonantQuality = 1.0;
  return path.second && path.pole.imag() != 0.0 &&
         std::abs(path.pole) > -2.0 * kResonantQuality * path.pole.real();
}

/// What a path makes, up to the output pin, per unit of weight: one function, two for a second-order path.
std::vector<std::vector<Complex>> path_functions(const ParallelPath& path, const std::vector<Complex>& input,
                                                 const NetworkResponse& response, std::int64_t sum) {
  const NetworkTarget& target = response.target();
  const std::vector<Complex>& d = response.d_of(path.divisor);
  const std::vector<Complex>& read = response.read_of(path.divisor, sum);
  const std::vector<Complex>& hold = response.hold_of(sum);
  const double period = period_of(path.divisor, target);
  std::vector<std::vector<Complex>> out(path.second ? 2 : 1);
  for (std::size_t k = 0; k < target.grid.size(); ++k) {
    const Complex way = input[k] * read[k] * hold[k];
    if (!path.second) {
      const double pole = d_pole(path.pole, period).real();
      const Complex late = path.by_ratios ? 1.0 - d[k] : 1.0;
      out[0].push_back(way * late / (1.0 - d[k] / pole));
      continue;
    }
    const SecondOrder below = second_order(path, period);
    const Complex q = d[k] * d[k] + below.linear * d[k] + below.constant;
    out[0].push_back(way * below.constant * (1.0 - d[k]) / q);
    out[1].push_back(way * (below.linear + below.constant) * d[k] / q);
  }
  return out;
}

/// What comes out of `before` at the sum's clock.
std::vector<Complex> input_of(const Network& before, const NetworkResponse& response) {
  if (before.stages.empty()) return std::vector<Complex>(response.target().grid.size(), 1.0);
  return response.nodes(before).back();
}

/// What the last stage of `before` reads.
int ahead_of(const Network& before) {
  return before.stages.empty() ? Stage::kBoardInput : before.stages.back().from[0];
}

/// What a path reads, at the sum's clock.
std::vector<Complex> input_of(const ParallelPath& path, const Network& before,
                              const NetworkResponse& response) {
  if (!path.ahead) return input_of(before, response);
  const int source = ahead_of(before);
  if (source == Stage::kBoardInput) return std::vector<Complex>(response.target().grid.size(), 1.0);
  return response.nodes(before)[static_cast<std::size_t>(source)];
}

/// An input of the chain of sums.
struct SumItem {
  int from = Stage::kBoardInput;
  double weight = 1.0;  ///< magnitude
  bool leads = false;   ///< with a static capacitor
};

/// Shares items out over the sums: `odd` enter at Sum1, Sum3, …, `even` at Sum2, Sum4, …
class SumChain {
 public:
  /// `lead`: what enters at Sum1 leads too (further on everything does, by the sums that read it).
  SumChain(std::vector<SumItem> odd, std::vector<SumItem> even, int capacitors, bool lead)
      : waiting_{std::move(even), std::move(odd)}, capacitors_(capacitors), lead_(lead) {}

  /// Capacitors of these inputs.
  static int need(const std::vector<SumItem>& items) {
    int out = 0;
    for (const SumItem& item : items) out += item.leads ? 2 : 1;
    return out;
  }

  /// Items of each sum, Sum1 first; all but the last also read the next one.
  std::vector<std::vector<SumItem>> shared() {
    std::vector<std::vector<SumItem>> out;
    while (out.empty() || !waiting_[0].empty() || !waiting_[1].empty()) {
      const std::size_t parity = (out.size() + 1) % 2;
      std::vector<SumItem>& mine = waiting_[parity];
      std::vector<SumItem> taken;
      if (lead_) {
        for (SumItem& item : mine) item.leads = out.empty() || item.from == Stage::kBoardInput;
      }
      int left = capacitors_ - 2;
      // The next sum is read with two capacitors, unless this one can take all that is left.
      if (!waiting_[1 - parity].empty() || need(mine) > left) left -= 2;
      while (!mine.empty() && need({mine.front()}) <= left) {
        left -= need({mine.front()});
        taken.push_back(mine.front());
        mine.erase(mine.begin());
      }
      out.push_back(std::move(taken));
    }
    return out;
  }

 private:
  std::vector<SumItem> waiting_[2];
  int capacitors_;
  bool lead_;
};

Stage low_pass_stage(const ParallelPath& path, double gain, const NetworkTarget& target, int cout) {
  const double pole = -1.0 / d_pole(path.pole, period_of(path.divisor, target)).real();  // Cint/Cout
  const double units =
      std::min({static_cast<double>(cout), kLargestRatio / pole, target.max_capacitor / std::max(1.0, gain)});
  Stage out;
  const double base = std::max(1.0, std::min(kLargestRatio / std::max(pole, 1.0), std::max(units, 1.0)));
  out.c = {gain * base, 0.0, base, pole * base};
  out.free = {0, 0, 0, 1};
  return out;
}

/// CA, C4 as large as they come; the pole is C2 C3/(CA C4), the second pole above the clock's reach.
Stage ratio_stage(const ParallelPath& path, double gain, const NetworkTarget& target) {
  constexpr double kFastPole = 3.0;  // C4/CB
  const double pole = -d_pole(path.pole, period_of(path.divisor, target)).real();
  const double big = target.max_capacitor;
  Stage out;
  out.kind = Stage::Kind::second_low;
  double ca = 2.0 * big;
  const double c4 = big;
  double loop = pole * ca * c4 / (1.0 + pole);
  const double most = big * std::min(1.0, 1.0 / gain);
  if (loop > most * most) {
    ca *= most * most / loop;
    loop = most * most;
  }
  // The first op-amp swings C4/C3 as far as the output: a large C3, and few units for the input and C2.
  constexpr double kFewUnits = 3.0;
  const double c2 =
      std::max(std::min(std::sqrt(loop), kFewUnits / std::min(1.0, gain)), loop / target.max_capacitor);
  out.c = {gain * c2, 0.0, 0.0, c2, loop / c2, c4, ca, c4 / kFastPole};
  out.free = {0, 0, 0, 1, 0, 0, 0, 0};
  return out;
}

Stage second_order_stage(const ParallelPath& path, double low, double band, const NetworkTarget& target) {
  const SecondOrder below = second_order(path, period_of(path.divisor, target));
  const double big = 0.8 * target.max_capacitor;
  Stage out;
  out.c1_inverting = low * (band == 0.0 ? 1.0 : band) > 0.0 || band == 0.0;
  out.free = {1, 1, 0, 1, 0, 1, 0, 0};
  if (is_high_quality(path)) {
    // Damped through C3 C4/(CA CB), two ratios: C4 stays of the size of CA/Q however fast the clock is.
    const double damp = below.linear + below.constant;
    const double gamma = damp / (1.0 + damp);
    const double each = std::sqrt(below.constant * (1.0 - gamma));
    out.kind = Stage::Kind::second_high;
    out.c = {std::abs(low) * each * big,
             std::abs(band) * gamma / each * big,
             0.0,
             each * big,
             each * big,
             gamma / each * big,
             big,
             big};
    return out;
  }
  const double beta = below.linear + below.constant;  // C4/CB
  const double each = std::sqrt(below.constant);
  out.kind = Stage::Kind::second_low;
  out.c = {std::abs(low) * each * big,
           std::abs(band) * beta * big,
           0.0,
           each * big,
           each * big,
           beta * big,
           big,
           big};
  return out;
}

/// Collects the stages of the paths and what the sums read.
class ParallelBuilder {
 public:
  ParallelBuilder(Network before, const NetworkResponse& response, const ParallelOptions& options)
      : target_(response.target()), options_(options), out_(std::move(before)) {
    source_ = out_.stages.empty() ? Stage::kBoardInput : static_cast<int>(out_.stages.size()) - 1;
    ahead_ = ahead_of(out_);
    // Of the output against what comes in here.
    const std::vector<Complex> input = input_of(out_, response);
    double in = 0.0;
    for (std::size_t k = 0; k < target_.grid.size(); ++k) {
      if (target_.weight[k] < 1.0) continue;
      peak_ = std::max(peak_, std::abs(target_.wanted[k]));
      in = std::max(in, std::abs(input[k]));
    }
    if (in > 0.0) peak_ /= in;
    if (peak_ < kFaint || peak_ > kLoud) link_ = std::sqrt(peak_);
  }

  void add_constant(double weight) {
    if (std::abs(weight) < kNegligibleWeight * peak_) return;
    (weight > 0.0 ? even_ : odd_).push_back({source_, std::abs(weight), true});
  }

  void add_path(const ParallelPath& path, double low, double band, double largest) {
    const double size = std::max(std::abs(low), std::abs(band));
    if (size < kNegligibleWeight * peak_) return;
    // Gain above 1 belongs into the path (its node may be as large as the output), small weights are shared.
    double gain = std::clamp(size, 1.0, std::max(1.0, peak_));
    const double small = kSmallWeight * std::max(largest / std::max(1.0, peak_), 1.0 / link_);
    if (size / gain < small) gain = std::max(std::sqrt(size), size / small);
    if (!path.second && !path.by_ratios) gain = std::max(gain, 1.0 / options_.cout);
    Stage stage = path.second      ? second_order_stage(path, low * gain / size, band * gain / size, target_)
                  : path.by_ratios ? ratio_stage(path, gain, target_)
                                   : low_pass_stage(path, gain, target_, options_.cout);
    stage.from = {path.ahead ? ahead_ : source_};
    stage.divisor = path.divisor;
    stage.name = fmt::format("{}{}", path.second ? "Path" : "LowPass", ++paths_);
    out_.stages.push_back(std::move(stage));
    const double sign = path.second && band != 0.0 ? band : low;
    (sign > 0.0 ? odd_ : even_).push_back({static_cast<int>(out_.stages.size()) - 1, size / gain, false});
  }

  Network finish(int cab_capacitors) {
    auto sums = SumChain(odd_, even_, cab_capacitors, options_.lead).shared();
    std::vector<double> links(sums.size() + 2, link_);  // with which Sum1 reads Sum2, Sum2 reads Sum3, …
    for (std::size_t level = 0; level < 2; ++level) split_small(level, cab_capacitors, sums, links);
    int next = Stage::kBoardInput;
    for (std::size_t s = sums.size(); s-- > 0;) {
      Stage sum;
      sum.name = fmt::format("Sum{}", s + 1);
      sum.divisor = options_.sum_divisor;
      const bool leads = s != split_at_ || split_leads_;
      if (s + 1 < sums.size()) add_input(sum, {next, links[s], leads}, false);
      double behind = 1.0;
      for (std::size_t k = 0; k < s; ++k) behind *= links[k];
      for (SumItem item : sums[s]) {
        item.weight /= behind;
        add_input(sum, item, true);
      }
      sum.c.push_back(kSumOut);
      sum.c.push_back(kSumStatic);
      sum.free.push_back(0);
      sum.free.push_back(0);
      next = static_cast<int>(out_.stages.size());
      out_.stages.push_back(std::move(sum));
    }
    return std::move(out_);
  }

 private:
  /// A constant path too small beside the other inputs for whole capacitors enters two sums further back, its
  /// weight shared between two ratios.
  void split_small(std::size_t level, int cab_capacitors, std::vector<std::vector<SumItem>>& sums,
                   std::vector<double>& links) {
    if (level >= sums.size() || sums.size() > level + 2) return;
    double largest = level + 1 < sums.size() ? links[level] : 0.0;
    double behind = 1.0;
    for (std::size_t k = 0; k < level; ++k) behind *= links[k];
    for (const SumItem& item : sums[level]) largest = std::max(largest, item.weight / behind);
    std::vector<SumItem> small;
    std::vector<SumItem> rest;
    for (const SumItem& item : sums[level]) {
      const bool split = item.from == source_ && item.weight / behind < kSplitWeight * largest;
      (split ? small : rest).push_back(item);
    }
    const bool reads_next = sums.size() == level + 2;
    const int next_need = reads_next ? 2 + SumChain::need(sums[level + 1]) : 2;
    const int own_need = SumChain::need(rest) + 2;
    if (small.empty() || next_need + 1 > cab_capacitors || own_need + 2 > cab_capacitors) return;
    split_leads_ = next_need + 2 <= cab_capacitors;
    split_at_ = level + 1;
    double most = 0.0;
    for (const SumItem& item : small) most = std::max(most, item.weight / behind);
    if (!reads_next) sums.emplace_back();
    sums.push_back(std::move(small));
    sums[level] = std::move(rest);
    links[level + 1] = std::sqrt(most / links[level]);
  }

  static void add_input(Stage& sum, const SumItem& item, bool free) {
    sum.from.push_back(item.from);
    sum.c.push_back(item.weight * kSumOut);
    sum.c.push_back(item.leads ? item.weight * (kSumStatic + 0.25 * kSumOut) : 0.0);
    sum.free.push_back(free ? 1 : 0);
    sum.free.push_back(item.leads ? 1 : 0);
  }

  const NetworkTarget& target_;
  const ParallelOptions& options_;
  Network out_;
  int source_;
  int ahead_;
  double peak_ = 0.0;
  double link_ = 1.0;  ///< weight with which a sum reads the one before it
  int paths_ = 0;
  std::size_t split_at_ = 1000;  ///< the sum that reads the one for small inputs
  bool split_leads_ = true;
  std::vector<SumItem> odd_, even_;
};

/// The two clocks nearest each other become the slower one until there are no more than `clocks`.
void merge_clocks(std::vector<ParallelPath>& paths, std::size_t clocks) {
  while (true) {
    std::set<std::int64_t> different;
    for (const ParallelPath& path : paths) different.insert(path.divisor);
    if (different.size() <= clocks) return;
    auto fast = different.begin();
    for (auto at = different.begin(); std::next(at) != different.end(); ++at) {
      if (*std::next(at) * *fast < *std::next(fast) * *at) fast = at;
    }
    const std::int64_t slow = *std::next(fast);
    for (ParallelPath& path : paths) {
      if (path.divisor == *fast) path.divisor = slow;
    }
  }
}

}  // namespace

std::vector<ParallelPath> with_clocks(std::vector<ParallelPath> paths, const NetworkTarget& target,
                                      const ParallelOptions& options) {
  const double slowest =
      options.lowest_clock_hz > 0.0 ? target.master_hz / options.lowest_clock_hz : kSlowestDivisor;
  std::vector<double> wanted;
  double most = 0.0;
  for (ParallelPath& path : paths) {
    double size = std::abs(path.pole);
    if (path.second) size = std::sqrt(size * std::abs(*path.second));
    const bool smaller = path.second && !is_high_quality(path);
    const double ratio = (smaller ? kSecondOrderShare : 1.0) * kLargestRatio / options.cout;
    wanted.push_back(target.master_hz / (ratio * size));
    path.by_ratios = !path.second && (path.by_ratios || wanted.back() > slowest);
    if (path.by_ratios) wanted.back() = std::max(path.least_divisor, target.master_hz / (kTwoRatios * size));
    wanted.back() = std::min(wanted.back(), slowest);
    most = std::max(most, wanted.back());
  }
  // Whole multiples of the sum's period, no faster than it; what one divisor does not reach is divided by the
  // second system clock first.
  const std::int64_t step = options.sum_divisor;
  const double reach = static_cast<double>(kLargestOneDivisor);
  const std::int64_t system =
      most <= reach
          ? step
          : step * whole_number<std::int64_t>(std::ceil(most / (reach * static_cast<double>(step))));
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const bool one = wanted[i] <= reach;
    // Behind the second system clock another divisor follows, which is even (or 1).
    const std::int64_t unit = one ? step : system == step ? step : 2 * system;
    const auto multiple = whole_number<std::int64_t>(std::floor(wanted[i] / static_cast<double>(unit) + 0.5));
    paths[i].divisor = unit * std::max<std::int64_t>(1, multiple);
    if (one && paths[i].divisor > kLargestOneDivisor) paths[i].divisor -= step;
  }
  merge_clocks(paths, options.clocks);
  return paths;
}

ParallelWeights parallel_weights(const std::vector<ParallelPath>& paths, const Network& before,
                                 const NetworkResponse& response, const ParallelOptions& options) {
  const NetworkTarget& target = response.target();
  const std::vector<Complex> input = input_of(before, response);
  const std::vector<Complex>& hold = response.hold_of(options.sum_divisor);
  std::vector<std::vector<Complex>> columns(1);
  // The constant path leads (static capacitors of the sums), which makes up for the delay of the hold.
  for (std::size_t k = 0; k < target.grid.size(); ++k) columns[0].push_back(input[k] * std::abs(hold[k]));
  std::vector<std::size_t> first;
  for (const ParallelPath& path : paths) {
    first.push_back(columns.size());
    const std::vector<Complex> own = path.ahead ? input_of(path, before, response) : input;
    for (auto& f : path_functions(path, own, response, options.sum_divisor)) columns.push_back(std::move(f));
  }
  const auto points = static_cast<Eigen::Index>(target.grid.size());
  const auto count = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(2 * points + count, count);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(2 * points + count);
  for (Eigen::Index k = 0; k < points; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const double scale = target.weight[i] * target.reciprocal[i];
    for (Eigen::Index c = 0; c < count; ++c) {
      const Complex v = columns[static_cast<std::size_t>(c)][i] * scale;
      a(2 * k, c) = v.real();
      a(2 * k + 1, c) = v.imag();
    }
    b[2 * k] = (target.wanted[i] * scale).real();
    b[2 * k + 1] = (target.wanted[i] * scale).imag();
  }
  for (Eigen::Index c = 0; c < count; ++c) {
    a(2 * points + c, c) = options.weight_deviation * a.col(c).head(2 * points).norm();
  }
  const Eigen::VectorXd x = solve_qr(a, b);
  ParallelWeights out;
  out.constant = x[0];
  for (std::size_t p = 0; p < paths.size(); ++p) {
    out.low.push_back(x[static_cast<Eigen::Index>(first[p])]);
    out.band.push_back(paths[p].second ? x[static_cast<Eigen::Index>(first[p] + 1)] : 0.0);
  }
  out.cost = (times(a, x) - b).squaredNorm();
  return out;
}

std::vector<std::vector<ParallelPath>> fewer_paths(std::vector<ParallelPath> paths, const Network& before,
                                                   const NetworkResponse& response,
                                                   const ParallelOptions& options) {
  std::vector<std::vector<ParallelPath>> out(paths.size());
  while (!paths.empty()) {
    out[paths.size() - 1] = paths;
    double least = std::numeric_limits<double>::infinity();
    std::vector<ParallelPath> best;
    for (std::size_t i = 0; i < paths.size(); ++i) {
      stop_if_interrupted();
      std::vector<ParallelPath> rest = paths;
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
      const double cost = parallel_weights(rest, before, response, options).cost;
      if (cost < least) {
        least = cost;
        best = std::move(rest);
      }
    }
    paths = std::move(best);
  }
  return out;
}

bool quicken_paths(std::vector<ParallelPath>& paths, const Network& before, const NetworkResponse& response,
                   const ParallelOptions& options, double clock_over) {
  const NetworkTarget& target = response.target();
  const ParallelWeights weights = parallel_weights(paths, before, response, options);
  bool any = false;
  for (std::size_t p = 0; p < paths.size(); ++p) {
    ParallelPath& path = paths[p];
    if (path.second || path.by_ratios || path.divisor <= options.sum_divisor) continue;
    const std::vector<Complex> input = input_of(path, before, response);
    const auto functions = path_functions(path, input, response, options.sum_divisor);
    const std::vector<Complex>& hold = response.hold_of(options.sum_divisor);
    double cost = 0.0;
    double at = 0.0;
    for (std::size_t k = 0; k < target.grid.size(); ++k) {
      const Complex exact = input[k] * hold[k] / (1.0 - Complex(0.0, target.grid[k].value) / path.pole);
      const double own =
          target.weight[k] * target.reciprocal[k] * std::abs(weights.low[p] * (functions[0][k] - exact));
      if (own > cost) {
        cost = own;
        at = target.grid[k].value;
      }
    }
    if (cost < kHoldWorthRatios) continue;
    // Fast against the frequency where it hurts; no faster than needed, the ratios stay moderate.
    path.by_ratios = true;
    path.least_divisor = target.master_hz / (clock_over * at / (2.0 * std::numbers::pi));
    any = true;
  }
  return any;
}

Network parallel_network(const std::vector<ParallelPath>& paths, Network before,
                         const NetworkResponse& response, const ParallelOptions& options) {
  constexpr int kCabCapacitors = 8;
  const ParallelWeights weights = parallel_weights(paths, before, response, options);
  ParallelBuilder builder(std::move(before), response, options);
  builder.add_constant(weights.constant);
  double largest = std::abs(weights.constant);
  for (const double w : weights.low) largest = std::max(largest, std::abs(w));
  for (std::size_t p = 0; p < paths.size(); ++p) {
    builder.add_path(paths[p], weights.low[p], weights.band[p], largest);
  }
  return builder.finish(kCabCapacitors);
}

}  // namespace bodesmith::fpaa
