#include "fpaa/search/chain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/whole_number.hpp"
#include "fpaa/device/clock_tree.hpp"
#include "fpaa/search/score.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr std::int64_t kMostTotal = kLargestDivisor * kLargestDivisor;
/// A corner needs this many samples a radian: above, no positive capacitors put a pole there.
constexpr double kSamplesARadian = 1.0;

double wanted_clock_hz(const StageRoots& stage, const ChainClocks& clocks, double band_top) {
  const double corner = stage.corner() / (2.0 * std::numbers::pi);
  const double share = stage.zeros.size() >= stage.poles.size() ? clocks.following : 1.0;
  return std::max(clocks.over_corner * corner, share * clocks.over_band * band_top);
}

/// How often the fastest clock is halved for each stage.
std::vector<int> halvings_of(const std::vector<StageRoots>& stages, const ChainClocks& clocks, double fastest,
                             std::int64_t divisor, double band_top) {
  int most = 0;
  while ((divisor << (most + 1)) <= kMostTotal) ++most;
  std::vector<int> out;
  for (const StageRoots& stage : stages) {
    if (stage.poles.empty() || clocks.one) {
      out.push_back(0);
      continue;
    }
    const double reach = stage.highest_clock_hz();
    const double wanted = std::max(wanted_clock_hz(stage, clocks, band_top), clocks.lowest.value);
    int j = 0;
    while (j < most && fastest / std::exp2(j + 1) >= std::min(wanted, reach) * (1.0 - kSame)) ++j;
    while (j < most && fastest / std::exp2(j) > reach * (1.0 + kSame)) ++j;
    out.push_back(j);
  }
  return out;
}

bool is_reached(const StageRoots& stage, double clock_hz, Hertz lowest) {
  if (clock_hz < lowest.value * (1.0 - kSame)) return false;
  if (clock_hz > 1.1 * stage.highest_clock_hz()) return false;
  for (const Complex& pole : stage.poles) {
    if (std::abs(pole) > kSamplesARadian * clock_hz) return false;
  }
  return true;
}

/// The order in which the stages stand.
std::vector<std::size_t> order_of(const std::vector<StageRoots>& stages, const std::vector<int>& halvings,
                                  const DesignTarget& target) {
  std::vector<std::size_t> left(stages.size());
  for (std::size_t s = 0; s < left.size(); ++s) left[s] = s;
  std::vector<std::vector<double>> own;  // ln |response| of each stage
  for (const StageRoots& stage : stages) {
    own.emplace_back();
    for (const RadPerSecond w : target.grid) own.back().push_back(std::log(stage.magnitude(w) + 1e-300));
  }
  std::vector<double> node(target.grid.size(), 0.0);
  std::vector<std::size_t> out;
  while (!left.empty()) {
    const int now = halvings[*std::ranges::min_element(
        left, [&](std::size_t a, std::size_t b) { return halvings[a] < halvings[b]; })];
    std::size_t best = left.size();
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < left.size(); ++i) {
      if (halvings[left[i]] != now) continue;
      double high = -1e300;
      double low = 1e300;
      for (std::size_t k = 0; k < node.size(); ++k) {
        if (target.weight[k] < 1.0) continue;
        const double here = node[k] + own[left[i]][k];
        high = std::max(high, here);
        low = std::min(low, here);
      }
      // What falls without end (a stop band) counts like any other deep place.
      const double range = std::min(high - low, 30.0);
      if (range < least * (1.0 - kSame)) {
        least = range;
        best = i;
      }
    }
    for (std::size_t k = 0; k < node.size(); ++k) node[k] += own[left[best]][k];
    out.push_back(left[best]);
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
  }
  return out;
}

/// The gain of the sections, shared by all stages; false when the sign is wrong.
bool set_gain(Design& design, const StageFactorTable& table) {
  const DesignTarget& target = table.target();
  const DesignResponse response(design, table);
  Complex mean = 0.0;
  double size = 0.0;
  double count = 0.0;
  for (std::size_t k = 0; k < target.grid.size(); ++k) {
    if (target.weight[k] < 1.0) continue;
    const Complex ratio = response.output(k) / target.wanted[k];
    if (!(std::abs(ratio) > 0.0) || !std::isfinite(std::abs(ratio))) continue;
    mean += ratio / std::abs(ratio);
    size += std::log(std::abs(ratio));
    count += 1.0;
  }
  if (!(mean.real() > 0.0) || count == 0.0) return false;
  DesignStage& first = design.stages.front();
  for (std::size_t i = 0; i < first.c.size(); ++i) {
    if (first.input_of(i) >= 0) first.c[i] *= std::exp(-size / count);
  }
  // A sum behind the first stage reads the board's input in addition to it.
  if (design.stages.size() > 1 && design.stages[1].from.size() == 2) {
    for (std::size_t i = 2; i < 4; ++i) design.stages[1].c[i] *= std::exp(-size / count);
  }
  return true;
}

}  // namespace

std::int64_t fastest_divisor(double master_hz, double clock_hz) {
  const double total = std::clamp(master_hz / clock_hz, 2.0, 65536.0);
  double by = 1.0;
  while (total / by > kLargestDivisor * (1.0 + kSame)) by *= 2.0;
  return whole_number<std::int64_t>(by) * 2 *
         whole_number<std::int64_t>(std::max(1.0, std::floor(total / by / 2.0 * (1.0 + kSame))));
}

std::optional<Chain> chain_design(std::vector<StageRoots> stages, const ChainClocks& clocks, int gains,
                                  const DesignTarget& target) {
  if (gains > 0) stages.insert(stages.begin(), static_cast<std::size_t>(gains), StageRoots{});
  const double band_top = target.band.to.value;
  double fastest = clocks.lowest.value;
  for (const StageRoots& stage : stages) {
    if (stage.poles.empty()) continue;
    fastest = std::max(fastest, std::min(wanted_clock_hz(stage, clocks, band_top), stage.highest_clock_hz()));
  }
  fastest = std::min(fastest, clocks.highest.value);
  const std::int64_t divisor = clocks.one ? *clocks.one : fastest_divisor(target.master_hz, fastest);
  fastest = target.master_hz / static_cast<double>(divisor);
  const std::vector<int> halvings =
      !clocks.halvings.empty() ? clocks.halvings : halvings_of(stages, clocks, fastest, divisor, band_top);
  Design out;
  int last = DesignStage::kBoardInput;
  for (const std::size_t s : order_of(stages, halvings, target)) {
    const double clock = fastest / std::exp2(halvings[s]);
    if (!is_reached(stages[s], clock, clocks.lowest)) return std::nullopt;
    const std::int64_t total[] = {divisor << halvings[s]};
    if (!common_system_divisor(total)) return std::nullopt;
    const std::vector<DesignStage> made = stages[s].poles.empty() ? std::vector{gain_stage(out.stages.size())}
                                                                  : initial_stages(stages[s], clock);
    if (made.empty()) return std::nullopt;
    const int base = static_cast<int>(out.stages.size());
    for (const DesignStage& stage : made) {
      out.stages.push_back(stage);
      DesignStage& added = out.stages.back();
      added.divisor = divisor << halvings[s];
      for (int& from : added.from) from = from == DesignStage::kBoardInput ? last : base + from;
      added.name = fmt::format("{}{}", stages[s].poles.empty() ? "Gain" : "Stage", out.stages.size());
    }
    last = static_cast<int>(out.stages.size()) - 1;
  }
  const StageFactorTable table(target);
  if (!set_gain(out, table)) return std::nullopt;
  scale_nodes(out, table);
  return Chain{std::move(out), divisor, halvings};
}

}  // namespace bodesmith::fpaa
