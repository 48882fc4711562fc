#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <tuple>

#include "base/error.hpp"
#include "base/text.hpp"
#include "multiplier_layout/budget.hpp"
#include "multiplier_layout/build.hpp"

namespace bodesmith::multiplier_layout {

Scheme Scheme::named(const std::string& name) {
  if (name == "auto") return {kAutomatic};
  if (name == "horner") return {kHorner};
  if (name == "shared") return {kShared};
  double group = 0.0;
  if (!parse_number(name, group) || group < 2.0 || group > 6.0 || group != std::floor(group)) {
    throw InputError(fmt::format("unknown scheme \"{}\", expected auto, shared, horner or 2 to 6", name));
  }
  return {static_cast<int>(group)};
}

namespace {

Candidate measure(const Layout& layout, int group, int degree) {
  Candidate out;
  out.group = group;
  out.name = group >= degree ? "shared powers" : (group == 1 ? "Horner" : fmt::format("x^{} (…)", group));
  out.multipliers = static_cast<int>(layout.multipliers.size());
  out.opamps = static_cast<int>(layout.opamps.size());
  std::map<std::string, int> depth;
  for (const Multiplier& m : layout.multipliers) {
    depth[m.out] = 1 + std::max({depth[m.x], depth[m.y], depth[m.z]});
    out.depth = std::max(out.depth, depth[m.out]);
  }
  const Budget budget = make_budget(layout);
  out.rss_percent = *std::max_element(budget.rss_percent.begin(), budget.rss_percent.end());
  double noise_gain = 1.0;
  for (const Sum& sum : layout.sums) noise_gain = std::max(noise_gain, sum.noise_gain);
  const double lag =
      out.depth / layout.multiplier.bandwidth.rad_s().value +
      (noise_gain + 1.0 + 1.0 / layout.branch_gain) / layout.opamp.gain_bandwidth.rad_s().value;
  out.bandwidth = Hertz{1.0 / (2.0 * std::numbers::pi * lag)};
  return out;
}

}  // namespace

/// Fewest multipliers among those whose budget is at most 1.5 times the least and whose bandwidth is at least
/// 20 times the highest reference frequency; of equals the fewest op-amps, then the least
/// error.
std::vector<Candidate> compare_schemes(const Input& input, const Options& options) {
  int most = 1;
  for (const Polynomial& one : input.branches) most = std::max(most, degree(one.coefficients));
  Options exact = options;
  exact.resistors = circuit::Series::named("exact");
  std::vector<Candidate> out;
  for (int group = most; group >= 1; --group) {
    try {
      out.push_back(measure(build(input, exact, group), group, most));
    } catch (const DesignError&) {
      // This split cannot be made; if none can, or it was asked for, building it says why.
    }
  }
  if (out.empty()) build(input, exact, most);  // throws the reason
  const int asked = std::min(options.scheme.group, most);
  if (options.scheme.group != Scheme::kAutomatic) {
    for (Candidate& one : out) one.chosen = one.group == asked;
    return out;
  }
  double min_error = std::numeric_limits<double>::infinity();
  for (const Candidate& one : out) min_error = std::min(min_error, one.rss_percent);
  Candidate* best = nullptr;
  for (Candidate& one : out) {
    if (one.rss_percent > 1.5 * min_error ||
        one.bandwidth.value < Scheme::kBandwidthRatio * options.highest.value)
      continue;
    const auto rank = [](const Candidate& c) { return std::tuple(c.multipliers, c.opamps, c.rss_percent); };
    if (best == nullptr || rank(one) < rank(*best)) best = &one;
  }
  // None is fast enough: the most accurate.
  if (best == nullptr) {
    best = &*std::min_element(out.begin(), out.end(), [](const Candidate& a, const Candidate& b) {
      return a.rss_percent < b.rss_percent;
    });
  }
  best->chosen = true;
  return out;
}

}  // namespace bodesmith::multiplier_layout
